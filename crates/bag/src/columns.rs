//! Any field of any topic as a column of numbers.

use crate::{
    codec::{Codec, OwnedSchema},
    container::{Damage, Visitor, Walk, walk, walk_from},
    error::BagError,
    record::{Channel, Message, Record},
};
use std::{
    collections::BTreeMap,
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
    let mut reading = Reading::of(wanted);
    let mut damage = walk(path, how, &mut reading)?;
    if reading.undeclared > 0 {
        // A lost chunk may have declared a channel that the summary repeats: go again, knowing it.
        reading = reading.again();
        damage = walk(path, how, &mut reading)?;
    }
    reading.finish(path, damage)
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
    source
        .read_to_end(&mut bytes)
        .map_err(|source| BagError::Io {
            path: name.to_owned(),
            source,
        })?;
    let mut reading = Reading::of(wanted);
    let mut damage = walk_from(name, Cursor::new(&bytes), how, &mut reading)?;
    if reading.undeclared > 0 {
        reading = reading.again();
        damage = walk_from(name, Cursor::new(&bytes), how, &mut reading)?;
    }
    reading.finish(name, damage)
}

/// Columns under way.
struct Reading<'a> {
    wanted: &'a [&'a str],
    columns: Vec<Column>,
    schemas: BTreeMap<u16, OwnedSchema>,
    channels: BTreeMap<u16, Channel>,
    /// By channel: how it is decoded, and which columns its numbers go to.
    plans: BTreeMap<u16, (Codec, Vec<usize>)>,
    refused: BTreeMap<String, String>,
    undeclared: usize,
    bad_messages: usize,
    row: Vec<f64>,
    /// Lengths of the columns, and counts, when the chunk began.
    mark: (Vec<usize>, usize, usize),
}

impl<'a> Reading<'a> {
    fn of(wanted: &'a [&'a str]) -> Self {
        let column = |name: &&str| Column {
            name: (*name).to_owned(),
            time_ns: Vec::new(),
            values: Vec::new(),
        };
        Self {
            wanted,
            columns: wanted.iter().map(column).collect(),
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            plans: BTreeMap::new(),
            refused: BTreeMap::new(),
            undeclared: 0,
            bad_messages: 0,
            row: Vec::new(),
            mark: Default::default(),
        }
    }

    /// The same from the start, with the declarations that were met.
    fn again(self) -> Self {
        let mut fresh = Self::of(self.wanted);
        fresh.schemas = self.schemas;
        self.channels.into_values().for_each(|c| fresh.declare(c));
        fresh
    }

    /// The path within messages of a topic, of a wanted column that is of this topic.
    fn within<'b>(wanted: &'b str, topic: &str) -> Option<&'b str> {
        wanted.strip_prefix(topic)?.strip_prefix('.')
    }

    fn declare(&mut self, channel: Channel) {
        if self.channels.contains_key(&channel.id) {
            return;
        }
        let paths = self.wanted.iter().enumerate();
        let paths = paths.filter_map(|(i, w)| Some((i, Self::within(w, &channel.topic)?)));
        let (columns, paths): (Vec<usize>, Vec<&str>) = paths.unzip();
        if !paths.is_empty() {
            let schema = self.schemas.get(&channel.schema_id);
            match Codec::compile(&channel, schema, &paths) {
                Ok(codec) => drop(self.plans.insert(channel.id, (codec, columns))),
                Err(why) => drop(self.refused.insert(channel.topic.clone(), why)),
            }
        }
        self.channels.insert(channel.id, channel);
    }

    fn take(&mut self, message: Message<'_>) {
        let Some((codec, columns)) = self.plans.get(&message.channel) else {
            self.undeclared += usize::from(!self.channels.contains_key(&message.channel));
            return;
        };
        let before: Vec<usize> = columns
            .iter()
            .map(|&c| self.columns[c].values.len())
            .collect();
        let rows = columns.iter().any(|&c| self.wanted[c].contains("[]"));
        let all = &mut self.columns;
        let mut put = |row: &[f64]| {
            for (&column, &value) in columns.iter().zip(row) {
                all[column].time_ns.push(message.log_ns);
                all[column].values.push((!value.is_nan()).then_some(value));
            }
        };
        let read = codec.run(message.data, &mut self.row, &mut |row| put(row));
        match read {
            Ok(()) if !rows => put(&self.row),
            Ok(()) => {}
            Err(_) => {
                // Half a message is none.
                for (&column, n) in columns.iter().zip(before) {
                    self.columns[column].time_ns.truncate(n);
                    self.columns[column].values.truncate(n);
                }
                self.bad_messages += 1;
            }
        }
    }

    fn finish(self, path: &Path, damage: Vec<Damage>) -> Result<Columns, BagError> {
        let planned = |i: &usize| self.plans.values().any(|(_, columns)| columns.contains(i));
        let missing = (0..self.wanted.len()).find(|i| !planned(i));
        if let Some(wanted) = missing.map(|i| self.wanted[i]) {
            let of_topic = |(topic, _): &(&String, &String)| Self::within(wanted, topic).is_some();
            if let Some((topic, why)) = self.refused.iter().find(of_topic) {
                return Err(BagError::Refused {
                    path: path.to_owned(),
                    topic: topic.clone(),
                    why: why.clone(),
                });
            }
            let mut found: Vec<String> = self.channels.into_values().map(|c| c.topic).collect();
            found.sort();
            found.dedup();
            let like = |topic: &String| strsim::jaro_winkler(topic, wanted);
            let nearest = found.iter().max_by(|a, b| like(a).total_cmp(&like(b)));
            return Err(BagError::UnknownTopic {
                path: path.to_owned(),
                wanted: wanted.to_owned(),
                nearest: nearest.cloned(),
                found,
            });
        }
        Ok(Columns {
            columns: self.columns,
            damage,
            bad_messages: self.bad_messages,
        })
    }
}

impl Visitor for Reading<'_> {
    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Schema(schema) => {
                self.schemas
                    .entry(schema.id)
                    .or_insert_with(|| schema.into());
            }
            Record::Channel(channel) => self.declare(channel),
            Record::Message(message) => self.take(message),
            Record::Header(..) | Record::Metadata(_) | Record::Other => {}
        }
    }

    fn passed_over(&mut self) {
        self.bad_messages += 1;
    }

    fn mark(&mut self) {
        let lengths = self.columns.iter().map(|c| c.values.len()).collect();
        self.mark = (lengths, self.undeclared, self.bad_messages);
    }

    fn roll_back(&mut self) {
        for (column, &n) in self.columns.iter_mut().zip(&self.mark.0) {
            column.time_ns.truncate(n);
            column.values.truncate(n);
        }
        (self.undeclared, self.bad_messages) = (self.mark.1, self.mark.2);
    }
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
