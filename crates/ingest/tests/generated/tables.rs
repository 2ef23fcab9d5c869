//! Small tables for the mappings that are shipped, and what tables trip over.

use std::fmt::Write as _;

/// Shipped mappings, and the name of a file that each reads.
pub(crate) const MAPPINGS: [(&str, &str); 9] = [
    ("openacc.toml", "oa_pair_r_f2_c.csv"),
    ("ngsim_pairs.toml", "i80_p_f1_l2.csv"),
    ("openacc_platoon.toml", "ASta.csv"),
    ("ngsim.toml", "n.csv"),
    ("ngsim_feet.toml", "n.csv"),
    ("highd.toml", "01_tracks.csv"),
    ("exid.toml", "00_tracks.csv"),
    ("ours.toml", "P01-own.csv"),
    ("comma2k19.toml", "a_40.csv"),
];

/// What tables and mappings trip over.
pub(crate) const WORDS: [&str; 28] = [
    "",
    ",",
    ",,,,",
    "\n",
    "\n\n",
    "\"",
    "\t",
    ";",
    "NaN",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "0",
    "-1",
    "9223372036854775807",
    "1e19",
    "null",
    "\u{feff}",
    "\0",
    "é",
    "2019-07-04T10:21:33Z",
    "?",
    "{n}",
    "[table]",
    "\"\"\"",
    "= \"frames\"",
];

/// A table of some rows that the mapping of this number reads.
pub(crate) fn table(which: usize, rows: u32) -> String {
    let mut text = String::new();
    match which {
        0 | 1 => text.push_str("t,x_follower,v_follower,x_leader,v_leader,leader_length,spacing\n"),
        2 => text.push_str("Freq,10\nTime,Speed1,Speed2,IVS1\n"),
        3 | 4 => text.push_str(
            "Vehicle_ID,Global_Time,Local_X,Local_Y,v_length,v_Vel,Lane_ID,Preceding,Location\n",
        ),
        5 => text.push_str("frame,id,x,y,width,height,xVelocity,yVelocity\n"),
        6 => text
            .push_str("trackId,frame,xCenter,yCenter,heading,length,xVelocity,yVelocity,leadId\n"),
        7 => text.push_str(
            "time_s,ego_x_m,ego_y_m,ego_speed_mps,lead_id,lead_dx_m,lead_dy_m,lead_speed_mps\n",
        ),
        _ => text.push_str("time_s,speed_mps,gap_m,lead,lead_speed_mps\n"),
    }
    for i in 0..rows {
        let t = f64::from(i) / 10.0;
        let row = match which {
            0 | 1 => format!("{t},{},20,{},21,4,26", 2 * i, 2 * i + 30),
            2 => format!("{t},20,21,30"),
            3 | 4 => format!(
                "{},{},10,{},4,20,{},0,us",
                i % 2 + 1,
                1_118_848_685_000_i64 + i64::from(i / 2) * 100,
                4 * i,
                i % 3
            ),
            5 => format!("{},{},{},25,4,2,30,0", i / 2, i % 2, 3 * i + i % 2 * 30),
            6 => format!("{},{},{},{},10,4,20,1,{}", i % 2, i / 2, i, i, 1 - i % 2),
            7 => format!("{t},{},0,30,5,20,0,29", 3 * i),
            _ => format!("{t},20,30,1,21"),
        };
        writeln!(text, "{row}").unwrap();
    }
    text
}
