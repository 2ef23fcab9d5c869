//! The time gap that a person keeps, over the whole drive.

use maveric_domain::Drive;

/// Median of the gap to the vehicle ahead in ego's own lane over ego speed, in s, over the samples at which there is one and ego moves;
/// none without such a sample. It is no measure of the paper's: it needs no lane change, so it exists for any rig that sees ahead.
pub fn median_time_gap_s(drive: &Drive) -> Option<f64> {
    let with_lead = (0..drive.len()).filter(|&row| drive.lead_ahead(row));
    let mut gaps: Vec<f64> = with_lead.filter_map(|row| drive.time_gap_s(row)).collect();
    gaps.sort_by(f64::total_cmp);
    let upper = *gaps.get(gaps.len() / 2)?;
    let lower = gaps[(gaps.len() - 1) / 2];
    Some(f64::midpoint(lower, upper))
}

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn a_lead_that_keeps_60_m_at_30_mps_is_2_s_and_an_empty_road_has_none() {
        let drive = Scripted::new(40.0).lead(60.0, 30.0).drive();
        let found = median_time_gap_s(&drive).unwrap();
        assert!((found - 2.0).abs() < 0.05, "{found}");
        assert_eq!(median_time_gap_s(&Scripted::new(40.0).drive()), None);
    }
}
