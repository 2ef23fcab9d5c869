//! JSON messages: the wanted numbers are picked out while reading, and nothing else is kept.

use super::wanted::{Slots, Taken, Tree, name_number};
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Which numbers of a channel's messages are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Plan {
    tree: Tree,
    slots: Slots,
}

impl Plan {
    /// A plan that fills slot i with the number at path `wanted[i]`: paths as in a ROS message.
    pub(crate) fn compile(wanted: &[&str]) -> Self {
        let tree = Tree::from_wanted(wanted);
        let slots = Slots::from_wanted(wanted, &tree);
        Self { tree, slots }
    }

    /// Reads a message: `row` is filled, and given to `each` for every element of the wanted sequence.
    ///
    /// # Errors
    /// A sentence, where the message is no JSON or a wanted number is missing.
    pub(crate) fn run(
        &self,
        message: &[u8],
        row: &mut Vec<f64>,
        each: &mut dyn FnMut(&[f64]),
    ) -> Result<(), String> {
        let mut taken = Taken::new(&self.slots);
        let mut reader = serde_json::Deserializer::from_slice(message);
        let seed = Seed { tree: &self.tree, taken: &mut taken };
        let read = seed.deserialize(&mut reader).and_then(|()| reader.end());
        read.map_err(|e| format!("it is no JSON: {e}"))?;
        self.slots.give(&mut taken, row, each)
    }
}

struct Seed<'a> {
    tree: &'a Tree,
    taken: &'a mut Taken,
}

impl Seed<'_> {
    fn number(self, value: f64) {
        self.taken.set(&self.tree.slots, value);
    }
}

impl<'de> DeserializeSeed<'de> for Seed<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Seed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<(), E> {
        self.number(f64::from(u8::from(value)));
        Ok(())
    }

    fn visit_i64<E>(self, value: i64) -> Result<(), E> {
        self.number(value as f64);
        Ok(())
    }

    fn visit_u64<E>(self, value: u64) -> Result<(), E> {
        self.number(value as f64);
        Ok(())
    }

    fn visit_f64<E>(self, value: f64) -> Result<(), E> {
        self.number(value);
        Ok(())
    }

    fn visit_str<E>(self, value: &str) -> Result<(), E> {
        if !self.tree.names.is_empty() {
            // A text that is wanted as one is none of a number: `007` is not 7.
            let number = name_number(value.as_bytes());
            self.taken.set(&self.tree.names, number);
        } else if let Ok(value) = value.parse() {
            // Whole numbers of 64 bits are often written as text.
            self.number(value);
        }
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(name) = map.next_key::<std::borrow::Cow<'de, str>>()? {
            match self.tree.fields.get(name.as_ref()) {
                Some(tree) => map.next_value_seed(Seed { tree, taken: &mut *self.taken })?,
                None => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        for index in 0.. {
            let item = self.tree.items.get(&index);
            let as_row = item.is_none() && self.tree.each.is_some() && self.taken.begin_row();
            let tree = if as_row { self.tree.each.as_deref() } else { item };
            let more = match tree {
                Some(tree) => {
                    seq.next_element_seed(Seed { tree, taken: &mut *self.taken })?.is_some()
                }
                None => seq.next_element::<IgnoredAny>()?.is_some(),
            };
            if as_row {
                self.taken.end_row();
                if !more {
                    self.taken.drop_row();
                }
            }
            if !more {
                break;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str, wanted: &[&str]) -> Result<Vec<Vec<f64>>, String> {
        let mut rows = Vec::new();
        let plan = Plan::compile(wanted);
        plan.run(text.as_bytes(), &mut Vec::new(), &mut |r| {
            rows.push(r.to_vec());
        })?;
        Ok(rows)
    }

    #[test]
    fn numbers_outside_rows_reach_every_row_whatever_the_order() {
        let text = r#"{"objects":[{"id":"7","size":[4.5,2]},{"size":[],"id":8}],"stamp":{"nsec":5,"sec":3}}"#;
        let wanted = ["stamp.sec|stamp.secs", "objects[].id", "objects[].size[0]?"];
        let found = rows(text, &wanted).unwrap();
        assert_eq!(found[0], [3.0, 7.0, 4.5]);
        assert_eq!(found[1][..2], [3.0, 8.0]);
        assert!(found[1][2].is_nan() && found.len() == 2);
    }

    #[test]
    fn a_text_that_is_wanted_is_no_number_and_too_many_rows_are_refused() {
        let wanted = ["cars[].id|cars[].id#"];
        let found = rows(r#"{"cars":[{"id":7},{"id":"7"},{"id":"007"},{"id":"car"}]}"#, &wanted);
        let found = found.unwrap();
        let ids: std::collections::BTreeSet<u64> = found.iter().map(|r| r[0].to_bits()).collect();
        assert_eq!((found[0][0], ids.len()), (7.0, 4));
        let many = format!("{{\"cars\":[{}0]}}", "0,".repeat(200_000));
        let error = rows(&many, &wanted).unwrap_err();
        assert_eq!(error, "it has more than 100000 rows");
    }

    #[test]
    fn what_is_no_json_and_a_missing_number_are_refused() {
        assert!(rows("{\"a\":", &["a"]).unwrap_err().contains("no JSON"));
        assert!(rows("{\"a\":1} x", &["a"]).unwrap_err().contains("no JSON"));
        assert!(rows("{\"b\":1}", &["a"]).unwrap_err().contains("`a`"));
        assert!(rows("[1]", &[]).is_ok());
    }
}
