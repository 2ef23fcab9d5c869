//! Which predictors a model has, and which products of them.

use std::{fmt, str::FromStr};

use crate::StatsError;

/// The fixed effects of a model, written as `a*b + x`: `*` stands for both and their interaction, `:` for an interaction alone.
///
/// Terms are in order of their degree, then as written. An interaction needs its parts beside it. There is always an intercept.
///
/// # Example
/// ```
/// use maveric_stats::Formula;
/// let formula: Formula = "age*style + speed".parse()?;
/// assert_eq!(formula.to_string(), "age + style + speed + age:style");
/// assert_eq!(formula.predictors(), ["age", "style", "speed"]);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Formula {
    predictors: Vec<String>,
    /// Positions in `predictors`, ascending.
    terms: Vec<Vec<usize>>,
}

impl Formula {
    /// Names of the predictors, in order of first appearance.
    pub fn predictors(&self) -> &[String] {
        &self.predictors
    }

    /// All factors with their products, and covariates beside them, by names that may hold any sign.
    ///
    /// # Errors
    /// [`StatsError::BadParameter`] without a name; [`StatsError::DoubleName`].
    pub fn crossed(factors: &[&str], covariates: &[&str]) -> Result<Self, StatsError> {
        let names: Vec<&str> = factors.iter().chain(covariates).copied().collect();
        if names.is_empty() {
            let expected = "at least 1 of them";
            return Err(StatsError::parameter("predictors", expected, 0.0));
        }
        StatsError::distinct("predictor", &names)?;
        let subsets = 1..1_usize << factors.len();
        let product = |bits: usize| (0..factors.len()).filter(move |f| bits >> f & 1 == 1);
        let mut terms: Vec<Vec<usize>> = subsets.map(|bits| product(bits).collect()).collect();
        terms.extend((factors.len()..names.len()).map(|covariate| vec![covariate]));
        terms.sort_by_key(|term| (term.len(), term.clone()));
        Ok(Self { predictors: names.into_iter().map(str::to_owned).collect(), terms })
    }

    /// The same with a covariate multiplied by each of these factors, one term more.
    ///
    /// # Errors
    /// [`StatsError::Formula`] for a name that is not in the formula.
    pub fn and_product(mut self, covariate: &str, factors: &[&str]) -> Result<Self, StatsError> {
        let place = |name: &&str| {
            let place = self.predictors.iter().position(|known| known == name);
            let known = || format!("one of {}", self.predictors.join(", "));
            place.ok_or_else(|| StatsError::formula(*name, known()))
        };
        let names = std::iter::once(&covariate).chain(factors);
        let term = names.map(place).collect::<Result<Vec<usize>, _>>()?;
        self.terms.push(term);
        Ok(self)
    }

    pub(super) fn terms(&self) -> &[Vec<usize>] {
        &self.terms
    }

    pub(super) fn name(&self, term: &[usize]) -> String {
        let names: Vec<&str> = term.iter().map(|&p| self.predictors[p].as_str()).collect();
        names.join(":")
    }

    /// Takes over one product, with all that `*` stands for.
    fn add(&mut self, text: &str) -> Result<(), StatsError> {
        let mut terms: Vec<Vec<usize>> = vec![Vec::new()];
        for part in text.split('*') {
            let mut product = Vec::new();
            for name in part.split(':').map(str::trim) {
                product.push(self.place(name, text)?);
            }
            // Without this part, and with it.
            let with: Vec<Vec<usize>> =
                terms.iter().map(|term| [&term[..], &product].concat()).collect();
            terms.extend(with);
        }
        for mut term in terms.into_iter().filter(|t| !t.is_empty()) {
            term.sort_unstable();
            term.dedup();
            if !self.terms.contains(&term) {
                self.terms.push(term);
            }
        }
        Ok(())
    }

    fn place(&mut self, name: &str, text: &str) -> Result<usize, StatsError> {
        if name.is_empty() || name.contains(['-', '(', ')', '^', '|', '~']) {
            return Err(StatsError::formula(
                text.trim(),
                "names of columns joined by + (both), : (their product) or * (both and their product)",
            ));
        }
        if let Some(place) = self.predictors.iter().position(|p| p == name) {
            return Ok(place);
        }
        self.predictors.push(name.to_owned());
        Ok(self.predictors.len() - 1)
    }

    /// Each interaction's parts must be terms too: without them coding would decide what is tested.
    fn check_parts(&self) -> Result<(), StatsError> {
        for term in &self.terms {
            for left_out in 0..term.len() {
                let mut part = term.clone();
                part.remove(left_out);
                if !part.is_empty() && !self.terms.contains(&part) {
                    let expected = format!("`{}` as a term beside it", self.name(&part));
                    return Err(StatsError::formula(self.name(term), expected));
                }
            }
        }
        Ok(())
    }
}

impl FromStr for Formula {
    type Err = StatsError;

    fn from_str(text: &str) -> Result<Self, StatsError> {
        let mut formula = Self { predictors: Vec::new(), terms: Vec::new() };
        for product in text.split('+') {
            // The intercept is there anyway.
            if product.trim() != "1" {
                formula.add(product)?;
            }
        }
        formula.terms.sort_by_key(Vec::len);
        formula.check_parts()?;
        Ok(formula)
    }
}

impl fmt::Display for Formula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = self.terms.iter().map(|term| self.name(term)).collect();
        f.write_str(&names.join(" + "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<String, StatsError> {
        text.parse::<Formula>().map(|f| f.to_string())
    }

    #[test]
    fn products_are_written_out_once() {
        assert_eq!(read("a*b*c").unwrap(), "a + b + c + a:b + a:c + b:c + a:b:c");
        assert_eq!(read("b + a + b:a + a*b").unwrap(), "b + a + b:a");
        assert_eq!(read("1 + x").unwrap(), "x");
    }

    #[test]
    fn crossed_factors_are_what_a_star_stands_for() {
        let made = Formula::crossed(&["a", "b", "c"], &["x"]).unwrap();
        assert_eq!(made, "a*b*c + x".parse().unwrap());
        let odd = Formula::crossed(&["driving style (1)"], &["age"]).unwrap();
        assert_eq!(odd.to_string(), "driving style (1) + age");
        let product = Formula::crossed(&["a", "b"], &["x"]).unwrap();
        let product = product.and_product("x", &["a", "b"]).unwrap();
        assert_eq!(product.to_string(), "a + b + x + a:b + x:a:b");
        assert!(product.and_product("x", &["c"]).is_err());
        assert!(Formula::crossed(&["a"], &["a"]).is_err());
        assert!(Formula::crossed(&[], &[]).is_err());
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        for (text, named) in [
            ("a + ", "expected names"),
            ("a:b + a", "`b`"),
            ("(1|id)", "(1|id)"),
            ("a - b", "a - b"),
        ] {
            assert!(read(text).unwrap_err().to_string().contains(named), "{text}");
        }
    }
}
