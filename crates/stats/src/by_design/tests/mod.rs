//! What is chosen for which design, and that it finds what the call of its own finds.

mod chosen;
mod covariates;
mod follow_up;
mod parts;
mod period;

use super::*;
use crate::{
    ByDesign, ChosenTest, Formula, OmnibusTest, Predictor, compare, factorial, groups, ordinal,
    random_by_factor,
};

/// A table of twelve people in two vehicles, in two modes on two roads.
struct Made {
    people: Vec<String>,
    mode: Vec<String>,
    road: Vec<String>,
    vehicle: Vec<Option<String>>,
    age: Vec<Option<f64>>,
    value: Vec<Option<f64>>,
}

/// Nearly normal numbers without order: 5 is a primitive root of 97.
fn noise(i: usize) -> f64 {
    let rank = (0..i).fold(5, |power, _| power * 5 % 97);
    crate::numerics::distributions::normal_quantile(f64::from(rank) / 97.0)
}

fn made() -> Made {
    let rows = 0..48;
    Made {
        people: rows.clone().map(|i| format!("p{}", i / 4)).collect(),
        mode: rows.clone().map(|i| ["calm", "sporty"][i % 2].to_owned()).collect(),
        road: rows.clone().map(|i| ["city", "country"][i / 2 % 2].to_owned()).collect(),
        vehicle: rows.clone().map(|i| Some(["car", "truck"][i / 4 % 2].to_owned())).collect(),
        age: rows.clone().map(|i| Some(20.0 + (i / 4 * 7 % 12) as f64)).collect(),
        value: rows.map(|i| Some(10.0 + noise(i) + (i % 2) as f64)).collect(),
    }
}

impl Made {
    /// Every row; every first one a person; or the rows on one road.
    fn rows(&self, keep: impl Fn(usize) -> bool) -> Self {
        fn of<T: Clone>(all: &[T], keep: &impl Fn(usize) -> bool) -> Vec<T> {
            let kept = all.iter().enumerate().filter(|(i, _)| keep(*i));
            kept.map(|(_, cell)| cell.clone()).collect()
        }
        Self {
            people: of(&self.people, &keep),
            mode: of(&self.mode, &keep),
            road: of(&self.road, &keep),
            vehicle: of(&self.vehicle, &keep),
            age: of(&self.age, &keep),
            value: of(&self.value, &keep),
        }
    }

    fn columns(&self) -> DesignColumns<'_> {
        DesignColumns { subjects: &self.people, values: &self.value, ..DesignColumns::default() }
    }

    fn within(&self) -> DesignColumns<'_> {
        DesignColumns { within: vec![("mode", &self.mode), ("road", &self.road)], ..self.columns() }
    }

    fn grouped(&self) -> DesignColumns<'_> {
        DesignColumns { between: vec![("vehicle", &self.vehicle)], ..self.within() }
    }
}

fn run(data: &DesignColumns<'_>) -> ByDesign {
    compare_by_design(data, &DesignChoice::default()).unwrap()
}

fn factorial_of(found: ByDesign) -> Chosen<FactorialFinding> {
    let ByDesign::Factorial(found) = found else { panic!("several factors") };
    *found
}
