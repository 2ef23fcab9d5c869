//! Any field of any topic as a column of numbers.

use crate::{
    codec::{Codec, OwnedSchema},
    container::{Damage, Walk, walk_from},
    error::BagError,
    record::{Channel, Message},
    streams::{Streams, Take, read_streams, streams_of},
};
use std::{
    io::{Cursor, Read},
    path::Path,
};

/// A field of a topic, message by message in the order of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// As it was asked for.
    pub name: String,
    /// Times of receipt, in ns; shape `(n,)`.
    pub time_ns: Vec<u64>,
    /// Values, none where an optional field is not there; shape `(n,)`.
    pub values: Vec<Option<f64>>,
}

/// What was asked for, and what was wrong on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// One column a name, in their order.
    pub columns: Vec<Column>,
    /// What is damaged; empty without [`Walk::recover`].
    pub damage: Vec<Damage>,
    /// Messages that do not fit their definition; they are in no column.
    pub bad_messages: usize,
}

/// Reads fields of a recording: each name is a topic, a point, and the path of a number in its messages.
///
/// Paths go down by points: `/imu.angular_velocity.z`; `/objects.objects[].id` gives a value for each element, `[0]` is
/// one element of an array, `a|b` the one of two that there is, and a path that ends in `?` may be missing. Booleans are 0 and 1;
/// a path to a text ends in `#` and gives its [`crate::name_number`].
///
/// # Errors
/// [`BagError::Io`], [`BagError::Damaged`]; [`BagError::UnknownTopic`] and [`BagError::Refused`] for a name that no channel has.
///
/// # Example
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut bag = maveric_bag::Writer::new(std::io::Cursor::new(Vec::new()), "example")?;
/// let imu = bag.channel("/imu", "json", ("lab.Imu", "jsonschema", "{}"))?;
/// bag.message(imu, 0, 5, br#"{"rate": {"z": 0.25}}"#)?;
/// let bytes = bag.finish()?.into_inner();
/// let read = maveric_bag::columns_from(&bytes[..], &["/imu.rate.z"], Default::default())?;
/// assert_eq!(read.columns[0].values, [Some(0.25)]);
/// # Ok(())
/// # }
/// ```
pub fn to_columns(path: &Path, wanted: &[&str], how: Walk<'_>) -> Result<Columns, BagError> {
    let taker = |channel: &Channel, schema: Option<&OwnedSchema>| {
        Fields::for_channel(wanted, channel, schema)
    };
    let parts = [path.to_owned()];
    finish(path, wanted, read_streams(&parts, how, taker)?)
}

/// Reads fields as [`to_columns`] does, from anything that can be read: it is kept in memory.
///
/// # Errors
/// As [`to_columns`]; its messages call the source `-`.
pub fn columns_from(
    mut source: impl Read,
    wanted: &[&str],
    how: Walk<'_>,
) -> Result<Columns, BagError> {
    let name = Path::new("-");
    let mut bytes = Vec::new();
    let read = source.read_to_end(&mut bytes);
    read.map_err(|e| BagError::io(name, e))?;
    let taker = |channel: &Channel, schema: Option<&OwnedSchema>| {
        Fields::for_channel(wanted, channel, schema)
    };
    let streams = streams_of(1, taker, |_, visitor| {
        walk_from(name, Cursor::new(&bytes), how, visitor)
    })?;
    finish(name, wanted, streams)
}

/// The wanted fields of one stream.
#[derive(Default)]
struct Fields {
    /// How its messages are decoded; none where nothing of it is wanted.
    codec: Option<Result<Codec, String>>,
    /// Which of the wanted columns the numbers of a row are for, and whether elements of an array give the rows.
    places: Vec<usize>,
    each: bool,
    /// Number of the message, its time of receipt, and the values of every row.
    nth: Vec<u32>,
    time_ns: Vec<u64>,
    values: Vec<f64>,
    bad: usize,
    row: Vec<f64>,
    /// Rows and bad messages when the chunk began.
    mark: (usize, usize),
}

impl Fields {
    fn for_channel(wanted: &[&str], channel: &Channel, schema: Option<&OwnedSchema>) -> Self {
        let paths = wanted.iter().enumerate();
        let paths = paths.filter_map(|(i, w)| Some((i, within(w, &channel.topic)?)));
        let (places, paths): (Vec<usize>, Vec<&str>) = paths.unzip();
        Self {
            codec: (!paths.is_empty()).then(|| Codec::compile(channel, schema, &paths)),
            each: paths.iter().any(|p| p.contains("[]")),
            places,
            ..Self::default()
        }
    }

    fn keep(&mut self, rows: usize) {
        self.nth.truncate(rows);
        self.time_ns.truncate(rows);
        self.values.truncate(rows * self.places.len());
    }
}

impl Take for Fields {
    fn take(&mut self, message: Message<'_>, nth: u32) {
        let Some(Ok(codec)) = &self.codec else {
            return;
        };
        let before = self.nth.len();
        let (numbers, times, values) = (&mut self.nth, &mut self.time_ns, &mut self.values);
        let mut put = |row: &[f64]| {
            numbers.push(nth);
            times.push(message.log_ns);
            values.extend_from_slice(row);
        };
        match codec.run(message.data, &mut self.row, &mut |row| put(row)) {
            Ok(()) if !self.each => put(&self.row),
            Ok(()) => {}
            Err(_) => {
                // Half a message is none.
                self.keep(before);
                self.bad += 1;
            }
        }
    }

    fn mark(&mut self) {
        self.mark = (self.nth.len(), self.bad);
    }

    fn roll_back(&mut self) {
        self.keep(self.mark.0);
        self.bad = self.mark.1;
    }
}

/// The path within messages of a topic, of a wanted column that is of this topic.
fn within<'b>(wanted: &'b str, topic: &str) -> Option<&'b str> {
    wanted.strip_prefix(topic)?.strip_prefix('.')
}

/// The columns of all streams; where two have a wanted one, their messages stay in the order of the file.
fn finish(path: &Path, wanted: &[&str], read: Streams<Fields>) -> Result<Columns, BagError> {
    let (path, streams) = (path.to_owned(), read.streams);
    let mut columns = Vec::with_capacity(wanted.len());
    for (i, name) in wanted.iter().enumerate() {
        let mut rows: Vec<(u32, u64, Option<f64>)> = Vec::new();
        let (mut there, mut refused) = (false, None);
        for stream in &streams {
            let fields = &stream.taken;
            let Some(place) = fields.places.iter().position(|&p| p == i) else {
                continue;
            };
            match &fields.codec {
                Some(Err(why)) => refused = Some((stream.channel.topic.clone(), why.clone())),
                _ => there = true,
            }
            let values = fields.values.chunks_exact(fields.places.len());
            rows.extend(
                values
                    .zip(&fields.nth)
                    .zip(&fields.time_ns)
                    .map(|((row, nth), ns)| (*nth, *ns, Some(row[place]).filter(|v| !v.is_nan()))),
            );
        }
        match refused {
            _ if there => {}
            Some((topic, why)) => return Err(BagError::Refused { path, topic, why }),
            None => {
                let mut topics: Vec<String> =
                    streams.into_iter().map(|s| s.channel.topic).collect();
                topics.sort();
                topics.dedup();
                let like = |topic: &String| strsim::jaro_winkler(topic, name);
                let nearest = topics.iter().max_by(|a, b| like(a).total_cmp(&like(b)));
                return Err(BagError::UnknownTopic {
                    path,
                    wanted: (*name).to_owned(),
                    nearest: nearest.cloned(),
                    found: topics,
                });
            }
        }
        rows.sort_by_key(|row| row.0);
        columns.push(Column {
            name: (*name).to_owned(),
            time_ns: rows.iter().map(|row| row.1).collect(),
            values: rows.iter().map(|row| row.2).collect(),
        });
    }
    Ok(Columns {
        columns,
        damage: read.walked.into_iter().flat_map(|w| w.damage).collect(),
        bad_messages: read.too_long + streams.iter().map(|s| s.taken.bad).sum::<usize>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CdrWriter, Writer};
    use std::sync::atomic::AtomicBool;

    const IMU: &str = "float64 stamp\nVector3 angular_velocity\n\
        ================================================================================\n\
        MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

    fn bag() -> Vec<u8> {
        let mut bag = Writer::new(Cursor::new(Vec::new()), "test").unwrap();
        let text = IMU.replace("Vector3 angular", "geometry_msgs/Vector3 angular");
        let imu = ("sensor_msgs/msg/Imu", "ros2msg", text.as_str());
        let imu = bag.channel("/imu", "cdr", imu).unwrap();
        let cars = bag.channel("/cars", "json", ("lab.Cars", "jsonschema", "{}"));
        let cars = cars.unwrap();
        for i in 0..100_u32 {
            let mut bytes = CdrWriter::new();
            bytes.restart();
            bytes.f64s(&[f64::from(i), 1.0, 2.0, 0.5 * f64::from(i)]);
            let time_ns = u64::from(i) * 1000;
            bag.message(imu, i, time_ns, bytes.bytes()).unwrap();
            let text = format!("{{\"cars\":[{{\"id\":1}},{{\"id\":{i},\"v\":3}}]}}");
            bag.message(cars, i, time_ns, text.as_bytes()).unwrap();
        }
        bag.finish().unwrap().into_inner()
    }

    #[test]
    fn fields_of_two_encodings_become_columns_with_their_times() {
        let names = ["/imu.angular_velocity.z", "/cars.cars[].v?", "/imu.stamp"];
        let read = columns_from(&bag()[..], &names, Walk::default()).unwrap();
        let z = &read.columns[0];
        assert_eq!((z.values[10], z.time_ns[10]), (Some(5.0), 10_000));
        assert_eq!(read.columns[1].values[..2], [None, Some(3.0)]);
        assert_eq!(
            read.columns
                .iter()
                .map(|c| c.values.len())
                .collect::<Vec<_>>(),
            [100, 200, 100]
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        std::fs::write(&path, bag()).unwrap();
        assert_eq!(to_columns(&path, &names, Walk::default()).unwrap(), read);
    }

    #[test]
    fn an_unknown_topic_an_unknown_field_damage_and_a_stop_are_told() {
        let of = |name: &str| columns_from(&bag()[..], &[name], Walk::default()).unwrap_err();
        assert!(of("/imi.stamp").to_string().contains("/cars, /imu"));
        assert!(
            matches!(of("/imi.stamp"), BagError::UnknownTopic { nearest: Some(n), .. } if n == "/imu")
        );
        assert!(of("/imu.height").to_string().contains("`height`"));
        let cut = &bag()[..bag().len() / 2];
        let read = |recover| {
            let how = Walk {
                recover,
                ..Walk::default()
            };
            columns_from(cut, &["/imu.stamp"], how)
        };
        assert!(matches!(read(false), Err(BagError::Damaged { .. })));
        assert_eq!(read(true).unwrap().damage.len(), 1);
        let stop = AtomicBool::new(true);
        let how = Walk {
            cancel: Some(&stop),
            ..Walk::default()
        };
        assert!(matches!(
            columns_from(&bag()[..], &[], how),
            Err(BagError::Cancelled)
        ));
    }
}
