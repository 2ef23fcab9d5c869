//! Reading a design: whether whoever rides has driven what their style is learned of.

use super::{
    condition::{Car, Condition},
    error::{Checked, refuse},
    protocol::{Protocol, ProtocolStep, World},
};

/// Whether the car of a condition has the style of whoever rides, or one that is found by it.
fn needs_own_style(condition: &Condition) -> bool {
    let elsewhere = matches!(condition.car, Some(Car::Mean | Car::Embedding(_)) | None);
    !elsewhere
}

/// Refuses rides in somebody's own style before a drive by hand. Where every car has a style of its own, or none is ours, nobody has to drive.
pub(super) fn ridden(protocol: &Protocol, conditions: &[Condition]) -> Checked<()> {
    let place = |step| protocol.steps.iter().position(|s| *s == step);
    let Some(rides) = place(ProtocolStep::Rides) else {
        return Ok(());
    };
    let driven = place(ProtocolStep::Drive).is_some_and(|drive| drive < rides);
    let Some(own) = conditions.iter().find(|c| needs_own_style(c)) else {
        return Ok(());
    };
    if driven {
        return replayed(protocol, conditions);
    }
    let expected = format!("`drive` before `rides`: the style of `{}` is learned from it", own.id);
    refuse("protocol.steps", "rides without a drive before them", expected)
}

/// Refuses a drive shown again beside rides that are in another world than it was, or last longer or shorter: they would differ by more than by who drives.
fn replayed(protocol: &Protocol, conditions: &[Condition]) -> Checked<()> {
    let Some(shown) = conditions.iter().find(|c| c.car == Some(Car::Replay)) else {
        return Ok(());
    };
    let id = shown.id;
    if protocol.world != World::Same {
        let world = if protocol.world == World::Own { "own" } else { "by_ride" };
        let expected = format!(
            "\"same\": `{id}` shows the drive by hand again, and every ride has to be in its world"
        );
        return refuse("protocol.world", world, expected);
    }
    if (protocol.ride_s - protocol.drive_s).abs() > 0.0 {
        let expected = format!(
            "{} as `drive_s`: `{id}` shows the drive by hand again, and every ride lasts as long",
            protocol.drive_s
        );
        return refuse("protocol.ride_s", protocol.ride_s, expected);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::Design;

    fn design(car: &str, steps: &str) -> Result<Design, String> {
        let text = format!(
            "[study]\ntitle = \"Rides\"\n[model]\nfile = \"lab.maveric\"\n[style]\nscore = \"adb.total\"\n\
             [[condition]]\nid = \"average\"\ncar = {{ mean = true, recorded = true }}\n[[condition]]\nid = \"other\"\n{car}\n\
             [protocol]\nsteps = {steps}\n"
        );
        Design::from_toml(&text).map_err(|e| e.to_string())
    }

    #[test]
    fn a_drive_is_shown_again_in_its_world_and_as_long_as_it_was() {
        let told = |protocol: &str| {
            let text = format!(
                "[study]\ntitle = \"Again\"\n[[condition]]\nid = \"again\"\ncar = {{ replay = \"own\" }}\n[protocol]\n{protocol}\n"
            );
            Design::from_toml(&text).map_err(|e| e.to_string())
        };
        let lasts = "steps = [\"drive\", \"rides\"]\ndrive_s = 120\nride_s = 120";
        let design = told(&format!("{lasts}\nworld = \"same\"")).unwrap();
        let [again] = design.conditions() else {
            panic!("{:?}", design.conditions());
        };
        assert_eq!((&again.car, again.recorded), (&Some(super::Car::Replay), true));
        assert!(!design.needs_a_model());
        for (protocol, key) in [
            (lasts.to_owned(), "protocol.world"),
            (format!("{lasts}\nworld = \"own\""), "protocol.world"),
            (
                format!("{}\nworld = \"same\"", lasts.replace("ride_s = 120", "ride_s = 60")),
                "protocol.ride_s",
            ),
            ("steps = [\"rides\"]\nworld = \"same\"".to_owned(), "protocol.steps"),
        ] {
            let error = told(&protocol).unwrap_err();
            assert!(error.contains(key), "{protocol}: {error}");
        }
    }

    #[test]
    fn nobody_has_to_drive_whose_rides_have_a_style_of_their_own_or_a_car_that_is_not_ours() {
        let file = "car = { embedding = \"styles.csv\", recorded = true }";
        for car in [file, "car = { mean = true, recorded = true }", ""] {
            assert!(design(car, "[\"rides\"]").is_ok(), "{car}");
        }
        for car in [
            "car = { dial = 0, recorded = true }",
            "car = { across = true, recorded = true }",
            "car = { other = \"matched\", recorded = true }",
            "car = { free = true }",
        ] {
            for steps in ["[\"rides\"]", "[\"rides\", \"drive\"]"] {
                let told = design(car, steps).unwrap_err();
                assert!(told.contains("the style of `other` is learned from it"), "{told}");
            }
            assert!(design(car, "[\"drive\", \"rides\"]").is_ok(), "{car}");
        }
    }
}
