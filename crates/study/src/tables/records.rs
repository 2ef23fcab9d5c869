//! Reading rows: the fields of a struct are the columns of a table, by their names. A field is text, a number, yes or no, a word of an
//! enum, or an `Option` of one of these.

use super::Table;
use crate::error::StudyError;
use maveric_domain::occasion::OCCASION;
use serde::{
    Deserialize, Deserializer,
    de::{
        self, DeserializeOwned, IntoDeserializer, Visitor,
        value::{MapDeserializer, SeqDeserializer},
    },
    forward_to_deserialize_any,
};
use std::{cell::Cell, fmt, path::Path};

/// Reads a table of a row each, as [`Table::records`] does.
pub fn read_rows<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, StudyError> {
    Table::read(path)?.records()
}

impl Table {
    /// The rows as values; columns that are none of their fields are passed over.
    ///
    /// # Errors
    /// [`StudyError::NoColumn`] for a field without a column, an optional one too; [`StudyError::BadCell`] with what the field's type
    /// says of the cell.
    pub fn records<T: DeserializeOwned>(&self) -> Result<Vec<T>, StudyError> {
        self.records_beside(&[])
    }

    /// As [`Table::records`], with fields that are not one column: for each its name and what it is in every row, nothing where it is
    /// missing.
    pub(super) fn records_beside<T: DeserializeOwned>(
        &self,
        lists: &[(&str, Vec<Option<Vec<f64>>>)],
    ) -> Result<Vec<T>, StudyError> {
        let rows = self.some_records(lists, |_| true)?;
        Ok(rows.into_iter().flatten().collect())
    }

    /// Those of these columns that the table does not have, missing in every row: for [`Table::records_beside`].
    pub(super) fn absent<'n>(&self, names: &[&'n str]) -> Vec<(&'n str, Vec<Option<Vec<f64>>>)> {
        let absent = names.iter().filter(|name| !self.has(name));
        absent.map(|name| (*name, vec![None; self.rows()])).collect()
    }

    /// As [`Table::records`], of those rows alone in which this column is not empty.
    pub(super) fn records_with<T: DeserializeOwned>(
        &self,
        column: &str,
    ) -> Result<Vec<Option<T>>, StudyError> {
        let cells = self.text(column)?;
        self.some_records(&[], |row| cells.get(row).is_some_and(Option::is_some))
    }

    fn some_records<T: DeserializeOwned>(
        &self,
        lists: &[(&str, Vec<Option<Vec<f64>>>)],
        wanted: impl Fn(usize) -> bool,
    ) -> Result<Vec<Option<T>>, StudyError> {
        // Tables of studies without several sessions and trials do not have these.
        let is_there = |name: &&str| !OCCASION.contains(name) || self.has(name);
        let names: Vec<&'static str> = columns::<T>().iter().copied().filter(is_there).collect();
        let list = |name: &str| lists.iter().find(|list| list.0 == name);
        let texts = names.iter().map(|name| match list(name) {
            Some(_) => Ok(Vec::new()),
            None => self.text(name),
        });
        let texts: Vec<Vec<Option<String>>> = texts.collect::<Result<_, _>>()?;
        let reading = Cell::new(0);
        let record = |row: usize| {
            let cell = |(at, column): (usize, &Vec<Option<String>>)| OneCell {
                text: column.get(row).cloned().flatten().unwrap_or_default(),
                list: list(names[at]).and_then(|list| list.1.get(row)?.clone()),
                optional: false,
                decimal_comma: self.decimal_comma,
                at,
                reading: &reading,
            };
            let cells = names.iter().copied().zip(texts.iter().enumerate().map(cell));
            T::deserialize(MapDeserializer::new(cells)).map_err(|Expected(expected)| {
                let column = reading.get();
                let text = texts[column].get(row).and_then(Option::as_deref);
                self.bad_cell(row, names[column], text.unwrap_or_default(), expected)
            })
        };
        let record = |row| wanted(row).then(|| record(row)).transpose();
        (0..self.rows()).map(record).collect()
    }
}

fn columns<'de, T: Deserialize<'de>>() -> &'static [&'static str] {
    let mut fields: &'static [&'static str] = &[];
    // It is given no value, so it can only fail; what it asked for is what is wanted.
    let _ = T::deserialize(Fields(&mut fields));
    fields
}

/// Notes which fields a struct asks for.
struct Fields<'a>(&'a mut &'static [&'static str]);

impl<'de> Deserializer<'de> for Fields<'_> {
    type Error = Expected;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Expected> {
        Err(Expected("a struct".to_owned()))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Expected> {
        *self.0 = fields;
        self.deserialize_any(visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct newtype_struct seq
        tuple tuple_struct map enum identifier ignored_any
    }
}

/// One cell, which says where it stands when it is read.
struct OneCell<'a> {
    text: String,
    /// Of a field that is not one column.
    list: Option<Vec<f64>>,
    /// Whether it may be missing.
    optional: bool,
    decimal_comma: bool,
    at: usize,
    reading: &'a Cell<usize>,
}

impl OneCell<'_> {
    fn missing(&self) -> bool {
        self.list.is_none() && matches!(self.text.trim(), "" | "NA" | "null")
    }

    fn whole(&self) -> Result<i64, Expected> {
        let rest = if self.optional { ", or empty where it was left out" } else { "" };
        let number = self.text.trim().parse();
        number.map_err(|_| Expected(format!("a whole number{rest}")))
    }
}

impl IntoDeserializer<'_, Expected> for OneCell<'_> {
    type Deserializer = Self;
    fn into_deserializer(self) -> Self {
        self.reading.set(self.at);
        self
    }
}

impl<'de> Deserializer<'de> for OneCell<'_> {
    type Error = Expected;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        visitor.visit_string(self.text)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        if self.missing() {
            return visitor.visit_none();
        }
        visitor.visit_some(Self { optional: true, ..self })
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        let value = self.text.trim().parse::<bool>();
        visitor.visit_bool(value.map_err(|_| Expected("true or false".to_owned()))?)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        match maveric_ingest::parse_number(self.text.trim(), self.decimal_comma) {
            Ok(value) => visitor.visit_f64(value),
            Err(_) if self.missing() => Err(Expected("a number".to_owned())),
            Err(expected) => Err(Expected(expected.to_owned())),
        }
    }

    fn deserialize_i32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        visitor.visit_i64(self.whole()?)
    }

    fn deserialize_i64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        visitor.visit_i64(self.whole()?)
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        visitor.visit_i64(self.whole()?)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        visitor.visit_i64(self.whole()?)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Expected> {
        visitor.visit_seq(SeqDeserializer::new(self.list.unwrap_or_default().into_iter()))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Expected> {
        visitor.visit_enum(self.text.into_deserializer())
    }

    forward_to_deserialize_any! {
        i8 i16 i128 u8 u16 u128 f32 char str string bytes byte_buf unit unit_struct newtype_struct tuple tuple_struct map struct
        identifier ignored_any
    }
}

/// What a cell should have been.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct Expected(String);

impl de::Error for Expected {
    fn custom<T: fmt::Display>(said: T) -> Self {
        Self(said.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{DrivenBy, ParticipantId};

    #[derive(Debug, PartialEq, Deserialize)]
    struct Row {
        participant: ParticipantId,
        driven_by: DrivenBy,
        note: String,
        score: Option<f64>,
        n: u32,
        answer: Option<i32>,
        kept: bool,
    }

    fn row(score: Option<f64>, answer: Option<i32>) -> Row {
        Row {
            participant: ParticipantId::new("P1").unwrap(),
            driven_by: DrivenBy::Human,
            note: String::new(),
            score,
            n: 4,
            answer,
            kept: true,
        }
    }

    fn read(text: &str) -> Result<Vec<Row>, String> {
        let table = Table::parse(Path::new("t.csv"), text.as_bytes().to_vec()).unwrap();
        table.records().map_err(|e| e.to_string())
    }

    #[test]
    fn a_cell_that_its_field_does_not_take_is_named_with_what_was_expected() {
        let head = "participant,driven_by,note,score,n,answer,kept\nP1,human,,NA,4,,true\n";
        assert_eq!(read(head).unwrap(), [row(None, None)]);
        for (line, column, expected) in [
            ("a b,human,,1,1,1,true", "participant", "1 to 64 letters"),
            ("P2,robot,,1,1,1,true", "driven_by", "`human`"),
            ("P2,human,,inf,1,1,true", "score", "a finite number"),
            ("P2,human,,1,,1,true", "n", "a whole number"),
            ("P2,human,,1,-1,1,true", "n", "u32"),
            ("P2,human,,1,1,1.5,true", "answer", "a whole number, or empty where it was left out"),
            ("P2,human,,1,1,1,yes", "kept", "true or false"),
        ] {
            let said = read(&format!("{head}{line}\n")).unwrap_err();
            let place = format!("t.csv: row 2, column `{column}`: found `");
            assert!(said.starts_with(&place) && said.contains(expected), "{said}");
        }
        let said = read("participant,driven_by,note,n,answer,kept\n").unwrap_err();
        assert!(said.contains("no column `score`"), "{said}");
    }
}
