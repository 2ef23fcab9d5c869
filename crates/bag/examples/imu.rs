//! How fast a robot turned, out of a recording that is made here.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_bag::{Walk, Writer, columns_from};
use std::io::Cursor;

fn main() -> Result<(), maveric_bag::BagError> {
    let mut bag = Writer::new(Cursor::new(Vec::new()), "example")?;
    let imu = bag.channel("/imu", "json", ("lab.Imu", "jsonschema", "{}"))?;
    for i in 0..100 {
        let text = format!(r#"{{"angular_velocity": {{"z": {}}}}}"#, f64::from(i).sin());
        bag.message(imu, i, u64::from(i) * 10_000_000, text.as_bytes())?;
    }
    let bytes = bag.finish()?.into_inner();
    let read = columns_from(&bytes[..], &["/imu.angular_velocity.z"], Walk::default())?;
    let fastest = read.columns[0]
        .values
        .iter()
        .flatten()
        .copied()
        .fold(0.0, f64::max);
    println!(
        "at most {fastest:.3} rad/s in {} messages",
        read.columns[0].values.len()
    );
    Ok(())
}
