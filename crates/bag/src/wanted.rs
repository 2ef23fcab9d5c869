//! Paths of wanted numbers within a message, and what is taken along them.

use std::collections::BTreeMap;

/// Most rows that one message may give: a thousand times as many vehicles as any rig sees.
pub(crate) const MOST_ROWS: usize = 100_000;

/// Whether a path need not be there: one that ends in `?`, and an empty one.
pub(crate) fn may_be_missing(path: &str) -> bool {
    path.is_empty() || path.ends_with('?')
}

/// The alternatives of a path, separated by `|`.
pub(crate) fn alternatives(path: &str) -> impl Iterator<Item = &str> {
    let paths = path.trim_end_matches('?').split('|');
    paths.filter(|p| !p.is_empty())
}

/// Whether a type has every wanted number that may not be missing: `matched` are those that its schema has.
///
/// # Errors
/// A sentence that names the first that it lacks.
pub(crate) fn all_matched(
    type_name: &str,
    wanted: &[&str],
    matched: &[bool],
) -> Result<(), String> {
    let lacks = |(path, matched): &(&&str, &bool)| !**matched && !may_be_missing(path);
    match wanted.iter().zip(matched).find(lacks) {
        Some((path, _)) => {
            Err(format!("`{type_name}` in its schema has no number `{}`", in_words(path)))
        }
        None => Ok(()),
    }
}

/// The alternatives of a path within quotes.
fn in_words(path: &str) -> String {
    path.replace('|', "` or `")
}

/// A name as a number, to compare it with others: of its part behind the last `/`, which may be a namespace's.
pub fn name_number(name: &[u8]) -> f64 {
    let name = name.strip_suffix(&[0]).unwrap_or(name);
    let last = name.rsplit(|&b| b == b'/').next().unwrap_or_default();
    // FNV-1a, as many bits of it as a float holds.
    let hash = last.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &b| {
        (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3)
    });
    (hash >> 11) as f64
}

/// Wanted paths as a tree: what to look for in a message that names its fields.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Tree {
    /// Slots that take the number here.
    pub(crate) slots: Vec<usize>,
    /// Slots that take the text here, as [`name_number`].
    pub(crate) names: Vec<usize>,
    /// Fields to look into.
    pub(crate) fields: BTreeMap<String, Self>,
    /// Of a sequence: every element gives a row.
    pub(crate) each: Option<Box<Self>>,
    /// Of a sequence: elements by their place.
    pub(crate) items: BTreeMap<usize, Self>,
}

impl Tree {
    /// The tree of some paths; slot i is path i.
    pub(crate) fn from_wanted(wanted: &[&str]) -> Self {
        let mut root = Self::default();
        for (slot, path) in wanted.iter().enumerate() {
            for path in alternatives(path) {
                match path.strip_suffix('#') {
                    Some(path) => root.at(path).names.push(slot),
                    None => root.at(path).slots.push(slot),
                }
            }
        }
        root
    }

    fn at(&mut self, path: &str) -> &mut Self {
        path.split('.').fold(self, |node, part| {
            let indexed = part.strip_suffix(']').and_then(|p| p.split_once('['));
            let (name, index) = indexed.map_or((part, None), |(name, i)| (name, Some(i)));
            let node = node.fields.entry(name.to_owned()).or_default();
            match index {
                None => node,
                Some(index) => match index.parse() {
                    Ok(index) => node.items.entry(index).or_default(),
                    Err(_) => node.each.get_or_insert_default(),
                },
            }
        })
    }

    /// The slots at and below this node.
    fn all_slots(&self) -> Vec<usize> {
        let below = self.fields.values().chain(self.items.values());
        let below = below.chain(self.each.as_deref());
        let mut slots = [self.slots.as_slice(), &self.names].concat();
        slots.extend(below.flat_map(Self::all_slots));
        slots
    }

    /// The slots within rows.
    fn row_slots(&self) -> Vec<usize> {
        let below = self.fields.values().chain(self.items.values());
        let mut slots: Vec<usize> = below.flat_map(Self::row_slots).collect();
        slots.extend(self.each.iter().flat_map(|each| each.all_slots()));
        slots
    }
}

/// Which slots a format with named fields fills, and which it must.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Slots {
    names: Vec<String>,
    in_rows: Vec<bool>,
}

impl Slots {
    /// For the paths behind a tree.
    pub(crate) fn from_wanted(wanted: &[&str], tree: &Tree) -> Self {
        let mut in_rows = vec![false; wanted.len()];
        for slot in tree.row_slots() {
            in_rows[slot] = true;
        }
        Self { names: wanted.iter().map(|&w| w.to_owned()).collect(), in_rows }
    }

    /// Gives every row to `each`, with the numbers that stand outside rows; leaves those in `row`.
    ///
    /// # Errors
    /// A sentence that names the first number that is missing.
    pub(crate) fn give(
        &self,
        taken: &mut Taken,
        row: &mut Vec<f64>,
        each: &mut dyn FnMut(&[f64]),
    ) -> Result<(), String> {
        let n = self.names.len();
        let check = |values: &[f64], of_rows: bool| {
            let lacks = |i: &usize| self.in_rows[*i] == of_rows && values[*i].is_nan();
            let mut lacking = (0..n).filter(lacks).map(|i| &self.names[i]);
            match lacking.find(|name| !may_be_missing(name)) {
                Some(name) => Err(format!("it has no number `{}`", in_words(name))),
                None => Ok(()),
            }
        };
        check(&taken.outer, false)?;
        if taken.too_many {
            return Err(format!("it has more than {MOST_ROWS} rows"));
        }
        for values in taken.rows.chunks_exact_mut(n.max(1)) {
            check(values, true)?;
            for i in (0..n).filter(|&i| !self.in_rows[i]) {
                values[i] = taken.outer[i];
            }
            each(values);
        }
        row.clear();
        row.extend_from_slice(&taken.outer);
        Ok(())
    }
}

/// Numbers taken from one message; fields may have come in any order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Taken {
    outer: Vec<f64>,
    rows: Vec<f64>,
    in_row: bool,
    too_many: bool,
}

impl Taken {
    pub(crate) fn new(slots: &Slots) -> Self {
        Self {
            outer: vec![f64::NAN; slots.names.len()],
            rows: Vec::new(),
            in_row: false,
            too_many: false,
        }
    }

    fn current(&mut self) -> &mut [f64] {
        let n = self.outer.len();
        if self.in_row {
            let start = self.rows.len() - n;
            &mut self.rows[start..]
        } else {
            &mut self.outer
        }
    }

    /// Puts a number into slots.
    pub(crate) fn set(&mut self, slots: &[usize], value: f64) {
        let current = self.current();
        for &slot in slots {
            current[slot] = value;
        }
    }

    /// Puts a number into slots that hold none yet.
    pub(crate) fn set_default(&mut self, slots: &[usize], value: f64) {
        let current = self.current();
        for &slot in slots {
            if current[slot].is_nan() {
                current[slot] = value;
            }
        }
    }

    /// Starts a row; false within another, where there is none.
    pub(crate) fn begin_row(&mut self) -> bool {
        if self.in_row || self.outer.is_empty() {
            return false;
        }
        if self.rows.len() >= MOST_ROWS * self.outer.len() {
            self.too_many = true;
            return false;
        }
        self.in_row = true;
        self.rows.extend(std::iter::repeat_n(f64::NAN, self.outer.len()));
        true
    }

    /// Takes the last row back.
    pub(crate) fn drop_row(&mut self) {
        let n = self.rows.len().saturating_sub(self.outer.len());
        self.rows.truncate(n);
    }

    pub(crate) fn end_row(&mut self) {
        self.in_row = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    fn slots(wanted: &[&str]) -> (Slots, Tree) {
        let tree = Tree::from_wanted(wanted);
        (Slots::from_wanted(wanted, &tree), tree)
    }

    #[test]
    fn a_name_s_number_is_the_upper_53_bits_of_its_fnv_1a_without_namespace_and_zero() {
        // The test vectors of the hash: 85944171f73967e8 for `foobar`, af63dc4c8601ec8c for `a`.
        let foobar = (0x8594_4171_f739_67e8_u64 >> 11) as f64;
        for name in ["foobar", "car/foobar", "/lab/car/foobar", "foobar\0", "car/foobar\0"] {
            assert_eq!(name_number(name.as_bytes()).to_bits(), foobar.to_bits());
        }
        assert_eq!(
            name_number(b"a").to_bits(),
            ((0xaf63_dc4c_8601_ec8c_u64 >> 11) as f64).to_bits()
        );
        assert_ne!(name_number(b"foobar\0\0").to_bits(), foobar.to_bits());
    }

    #[test]
    fn a_path_may_be_missing_if_it_ends_so_and_has_its_alternatives() {
        assert!(may_be_missing("") && may_be_missing("a?") && !may_be_missing("a"));
        assert_eq!(alternatives("a|b.c|?").collect::<Vec<_>>(), ["a", "b.c"]);
        assert_eq!(alternatives("").count(), 0);
    }

    #[test]
    fn slots_within_rows_are_those_below_a_sequence() {
        let (slots, tree) =
            slots(&["t", "cars[].id|cars[].id#", "cars[].size[0]", "list[2].x", "a.b[].c"]);
        assert_eq!(slots.in_rows, [false, true, true, false, true]);
        assert_eq!(tree.fields["t"].slots, [0]);
        let cars = tree.fields["cars"].each.as_ref().unwrap();
        assert_eq!((&cars.fields["id"].slots, &cars.fields["id"].names), (&vec![1], &vec![1]));
        assert_eq!(cars.fields["size"].items[&0].slots, [2]);
        assert_eq!(tree.fields["list"].items[&2].fields["x"].slots, [3]);
    }

    #[test]
    fn rows_are_as_many_as_allowed_whatever_their_width_and_one_more_is_too_many() {
        let (slots, _) = slots(&["a[].x", "a[].y", "t"]);
        for (rows, fits) in [(MOST_ROWS, true), (MOST_ROWS + 1, false)] {
            let mut taken = Taken::new(&slots);
            taken.set(&[2], 7.0);
            for _ in 0..rows {
                if taken.begin_row() {
                    assert!(!taken.begin_row(), "none within another");
                    taken.set(&[0, 1], 1.0);
                    taken.end_row();
                }
            }
            let mut given = 0;
            let all = slots.give(&mut taken, &mut Vec::new(), &mut |row| {
                given += 1;
                assert_eq!(row, [1.0, 1.0, 7.0]);
            });
            assert_eq!((all.is_ok(), given), (fits, if fits { MOST_ROWS } else { 0 }));
        }
        assert!(!Taken::new(&Slots::from_wanted(&[], &Tree::default())).begin_row());
    }

    #[test]
    fn a_missing_number_is_named_and_what_may_be_missing_is_none() {
        let (slots, _) = slots(&["t", "a[].x", "a[].y?"]);
        let mut row = Vec::new();
        let mut taken = Taken::new(&slots);
        let error = slots.give(&mut taken, &mut row, &mut |_| {}).unwrap_err();
        assert_eq!(error, "it has no number `t`");
        taken.set(&[0], 5.0);
        taken.set_default(&[0], 6.0);
        slots.give(&mut taken, &mut row, &mut |_| panic!("no row")).unwrap();
        assert_eq!(row[0].to_bits(), 5.0_f64.to_bits(), "the first stays");
        assert!(taken.begin_row());
        taken.set_default(&[1], 8.0);
        taken.end_row();
        assert!(taken.begin_row());
        taken.drop_row();
        taken.end_row();
        let mut rows = Vec::new();
        slots.give(&mut taken, &mut row, &mut |r| rows.push(r.to_vec())).unwrap();
        assert_eq!(rows.len(), 1, "the last was taken back");
        assert_eq!(rows[0][..2], [5.0, 8.0]);
        assert!(rows[0][2].is_nan());
        assert!(taken.begin_row());
        taken.end_row();
        let error = slots.give(&mut taken, &mut row, &mut |_| {}).unwrap_err();
        assert_eq!(error, "it has no number `a[].x`");
    }
}
