//! Samples as recorded, stored by column: most of what is done with them looks at one or two columns of many rows.

/// What a column holds of a value: an `Option` takes twice the room, so that NaN stands for none.
pub(crate) trait Cell: Copy {
    type Stored: Copy;
    fn stored(self) -> Self::Stored;
    fn from_stored(stored: Self::Stored) -> Self;
}

macro_rules! plain_cells {
    ($($kind:ty)*) => {
        $(impl Cell for $kind {
            type Stored = $kind;
            fn stored(self) -> $kind {
                self
            }
            fn from_stored(stored: $kind) -> Self {
                stored
            }
        })*
    };
}
plain_cells!(i64 u32 f64);

impl Cell for Option<f64> {
    type Stored = f64;
    fn stored(self) -> f64 {
        self.unwrap_or(f64::NAN)
    }
    fn from_stored(stored: f64) -> Self {
        (!stored.is_nan()).then_some(stored)
    }
}

/// Places in time with what else a sample holds.
pub(crate) trait Timed {
    /// Times stamped by the source, in ns.
    fn stamps(&self) -> &[i64];
    /// The same, to be set.
    fn stamps_mut(&mut self) -> &mut Vec<i64>;
    /// Times of receipt, in ns.
    fn receipts(&self) -> &[i64];
    /// Numbers of the messages or rows that they came in.
    fn numbers(&self) -> &[u32];
    /// Of what each may come once at one time: numbers of vehicles; none where all are of one thing.
    fn ids(&self) -> Option<&[u32]>;
    /// The columns in which every number has to be one, and whether NaN is none there.
    fn values(&self) -> Vec<(&[f64], bool)>;
    /// Keeps the samples at some places only.
    fn keep(&mut self, keep: impl FnMut(usize) -> bool);
    /// Puts the samples in another order: the places that they come from.
    fn reorder(&mut self, order: &[usize]);

    /// What may come once: a vehicle at a time.
    fn key(&self, i: usize) -> (i64, u32) {
        (self.stamps()[i], self.ids().map_or(0, |ids| ids[i]))
    }

    /// Whether every number of each sample is one.
    fn finite(&self) -> Vec<bool> {
        let values = self.values();
        let finite = |&(column, or_none): &(&[f64], bool), i: usize| {
            column[i].is_finite() || (or_none && column[i].is_nan())
        };
        let all_finite = |i: usize| values.iter().all(|value| finite(value, i));
        (0..self.stamps().len()).map(all_finite).collect()
    }

    /// Whether that is so of all.
    fn all_finite(&self) -> bool {
        // Without a branch: columns are long and almost always finite.
        let finite = |(column, or_none): (&[f64], bool)| {
            let is_bad = |v: &f64| !v.is_finite() & !(or_none & v.is_nan());
            !column.iter().fold(false, |bad, v| bad | is_bad(v))
        };
        self.values().into_iter().all(finite)
    }

    /// Whether each comes later than the one before, or at its time as a thing of a higher number.
    fn rises(&self) -> bool {
        let stamps = self.stamps();
        match self.ids() {
            None => stamps.is_sorted_by(|a, b| a < b),
            Some(_) => (1..stamps.len()).all(|i| self.key(i - 1) < self.key(i)),
        }
    }

    /// Sorts by time and thing: of two at one time the first that came stays the first.
    fn sort(&mut self) {
        let mut order: Vec<usize> = (0..self.stamps().len()).collect();
        order.sort_by_key(|&i| self.key(i));
        self.reorder(&order);
    }

    /// Keeps the first of those of one thing at one time; they are sorted.
    fn dedup(&mut self) {
        let twice: Vec<bool> =
            (0..self.stamps().len()).map(|i| i > 0 && self.key(i - 1) == self.key(i)).collect();
        self.keep(|i| !twice[i]);
    }
}

/// A sample, and many of them by column: `ids` are of what each may come once at one time, `values` what has to be a number (or none).
macro_rules! samples {
    (
        $(#[$doc:meta])* $sample:ident, $columns:ident,
        ids: $ids:expr, values: $values:expr,
        { $($fields:tt)* }
    ) => {
        samples! {
            @all $(#[$doc])* $sample, $columns, $ids, $values,
            /// Time stamped by the source, in ns.
            stamp_ns: i64,
            /// Time of receipt, in ns.
            log_ns: i64,
            /// Number of the message or row that it came in; 0 where samples are not in the order of a file.
            nth: u32,
            $($fields)*
        }
    };
    (
        @all $(#[$doc:meta])* $sample:ident, $columns:ident, $ids:expr, $values:expr,
        $($(#[$field_doc:meta])* $field:ident: $kind:ty,)*
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub(crate) struct $sample {
            $($(#[$field_doc])* pub(crate) $field: $kind,)*
        }

        /// The same, by column; every column has shape `(n,)`.
        #[derive(Debug, Clone, PartialEq, Default)]
        pub(crate) struct $columns {
            $(pub(crate) $field: Vec<<$kind as Cell>::Stored>,)*
        }

        #[allow(dead_code, reason = "not every kind of samples needs all of it")]
        impl $columns {
            pub(crate) fn len(&self) -> usize {
                self.stamp_ns.len()
            }

            pub(crate) fn is_empty(&self) -> bool {
                self.stamp_ns.is_empty()
            }

            /// The sample at a place that there is.
            pub(crate) fn at(&self, i: usize) -> $sample {
                $sample {
                    $($field: Cell::from_stored(self.$field[i]),)*
                }
            }

            /// The sample at a place.
            pub(crate) fn get(&self, i: usize) -> Option<$sample> {
                (i < self.len()).then(|| self.at(i))
            }

            pub(crate) fn first(&self) -> Option<$sample> {
                self.get(0)
            }

            pub(crate) fn last(&self) -> Option<$sample> {
                self.get(self.len().checked_sub(1)?)
            }

            pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = $sample> + ExactSizeIterator + '_ {
                (0..self.len()).map(|i| self.at(i))
            }

            pub(crate) fn push(&mut self, sample: $sample) {
                $(self.$field.push(sample.$field.stored());)*
            }

            fn put(&mut self, i: usize, sample: $sample) {
                $(self.$field[i] = sample.$field.stored();)*
            }

            /// Keeps some of the samples.
            pub(crate) fn retain(&mut self, mut keep: impl FnMut(&$sample) -> bool) {
                let mut kept = 0;
                for i in 0..self.len() {
                    let sample = self.at(i);
                    if keep(&sample) {
                        if kept < i {
                            self.put(kept, sample);
                        }
                        kept += 1;
                    }
                }
                self.truncate(kept);
            }

            /// Changes samples and keeps some of them.
            pub(crate) fn retain_mut(&mut self, mut keep: impl FnMut(&mut $sample) -> bool) {
                let mut kept = 0;
                for i in 0..self.len() {
                    let mut sample = self.at(i);
                    if keep(&mut sample) {
                        self.put(kept, sample);
                        kept += 1;
                    }
                }
                self.truncate(kept);
            }

            pub(crate) fn truncate(&mut self, len: usize) {
                $(self.$field.truncate(len);)*
            }

            pub(crate) fn reserve_exact(&mut self, more: usize) {
                $(self.$field.reserve_exact(more);)*
            }
        }

        impl Timed for $columns {
            fn stamps(&self) -> &[i64] {
                &self.stamp_ns
            }
            fn stamps_mut(&mut self) -> &mut Vec<i64> {
                &mut self.stamp_ns
            }
            fn receipts(&self) -> &[i64] {
                &self.log_ns
            }
            fn numbers(&self) -> &[u32] {
                &self.nth
            }
            fn ids(&self) -> Option<&[u32]> {
                let ids: fn(&Self) -> Option<&[u32]> = $ids;
                ids(self)
            }
            fn values(&self) -> Vec<(&[f64], bool)> {
                let values: fn(&Self) -> Vec<(&[f64], bool)> = $values;
                values(self)
            }
            fn keep(&mut self, mut keep: impl FnMut(usize) -> bool) {
                let mut i = 0;
                self.retain(|_| {
                    i += 1;
                    keep(i - 1)
                });
            }
            fn reorder(&mut self, order: &[usize]) {
                $(self.$field = order.iter().map(|&i| self.$field[i]).collect();)*
            }
        }

        impl Extend<$sample> for $columns {
            fn extend<T: IntoIterator<Item = $sample>>(&mut self, samples: T) {
                for sample in samples {
                    self.push(sample);
                }
            }
        }

        impl FromIterator<$sample> for $columns {
            fn from_iter<T: IntoIterator<Item = $sample>>(samples: T) -> Self {
                let samples = samples.into_iter();
                let mut columns = Self::default();
                columns.reserve_exact(samples.size_hint().0);
                columns.extend(samples);
                columns
            }
        }
    };
}

samples! {
    /// Where ego was at one time, as recorded.
    EgoSample, EgoSamples,
    ids: |_| None,
    values: |s| vec![(&s.x_m, false), (&s.y_m, false), (&s.speed_mps, true)],
    {
        /// Position of the centre in the log's frame, in m.
        x_m: f64,
        /// Position of the centre in the log's frame, in m.
        y_m: f64,
        /// Heading in the log's frame, in rad.
        yaw_rad: Option<f64>,
        /// Speed, in m/s; none where only poses were recorded.
        speed_mps: Option<f64>,
    }
}

samples! {
    /// Where another vehicle was at one time, as recorded.
    ObjectSample, ObjectSamples,
    ids: |s| Some(&s.id),
    values: |s| vec![(&s.x_m, false), (&s.y_m, false), (&s.speed_mps, true)],
    {
        /// Number within the log.
        id: u32,
        /// Position of the centre in the log's frame, in m.
        x_m: f64,
        /// Position of the centre in the log's frame, in m.
        y_m: f64,
        /// Speed, in m/s; NaN where it was not recorded and is differentiated from the positions.
        speed_mps: f64,
        /// Bumper to bumper, in m; NaN where it is not known.
        length_m: f64,
    }
}

samples! {
    /// Ego's speed at one time, from a channel of its own.
    SpeedSample, SpeedSamples,
    ids: |_| None,
    values: |s| vec![(&s.speed_mps, false)],
    {
        /// Speed, in m/s.
        speed_mps: f64,
    }
}

samples! {
    /// A time at which somebody looked who else is there, whoever was.
    Sighting, Sightings,
    ids: |_| None,
    values: |_| Vec::new(),
    {}
}

impl EgoSample {
    /// Whether every number of it is one.
    pub(crate) fn is_finite(&self) -> bool {
        self.x_m.is_finite() && self.y_m.is_finite() && self.speed_mps.is_none_or(f64::is_finite)
    }
}

impl ObjectSample {
    /// Bumper to bumper, in m, where it is known.
    pub(crate) fn known_length_m(&self) -> Option<f64> {
        Cell::from_stored(self.length_m)
    }

    /// The same of ego.
    pub(crate) fn as_ego(&self) -> EgoSample {
        EgoSample {
            stamp_ns: self.stamp_ns,
            log_ns: self.log_ns,
            nth: self.nth,
            x_m: self.x_m,
            y_m: self.y_m,
            yaw_rad: None,
            speed_mps: Cell::from_stored(self.speed_mps),
        }
    }
}
