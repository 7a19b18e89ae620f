//! A row: name, parameters, and what makes the thing.

use crate::{Given, Parameter};

/// Why parameters make nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{parameter}: {message}; {remedy}")]
pub struct Refusal {
    /// The parameter that is to be changed.
    pub parameter: &'static str,
    /// Message: what is wrong with it.
    pub message: String,
    /// Remedy: what to do.
    pub remedy: String,
}

impl Refusal {
    /// A refusal from its parts.
    pub fn new(parameter: &'static str, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { parameter, message: message.into(), remedy: remedy.into() }
    }
}

/// A row of a catalogue. `T` is what it makes, mostly `Arc<dyn Trait>`.
#[derive(Debug)]
pub struct Row<T: 'static> {
    /// Name in scenes.
    pub name: &'static str,
    /// Equation and use.
    pub about: &'static str,
    /// Ways to give the parameters: all of exactly one of them. One way, if there is no choice.
    pub ways: &'static [&'static [Parameter]],
    /// Makes it: of the number of the way in which its parameters are given, and one value for each parameter of that way, each in its range. Refuses combinations that are nothing.
    pub make: fn(usize, &[Given<'_>]) -> Result<T, Refusal>,
}

/// The row of that name, if there is one.
pub fn entry<T>(rows: &'static [Row<T>], name: &str) -> Option<&'static Row<T>> {
    rows.iter().find(|row| row.name == name)
}

impl<T> Row<T> {
    /// The parameters of all ways.
    pub fn parameters(&self) -> impl Iterator<Item = &'static Parameter> + use<T> {
        self.ways.iter().copied().flatten()
    }

    /// The way in which parameters are given, of which `has` tells whether they are there.
    ///
    /// # Errors
    /// None of any way is there, or some of several.
    pub fn way(&self, has: impl Fn(&str) -> bool) -> Result<usize, Refusal> {
        if let [_] = self.ways {
            return Ok(0);
        }
        let mut present = self.ways.iter().enumerate().filter_map(|(way, parameters)| {
            parameters.iter().find(|parameter| has(parameter.name)).map(|first| (way, first))
        });
        let Some((way, one)) = present.next() else {
            let first = self.ways[0];
            let example: Vec<String> = first.iter().map(|p| format!("{} = {}", p.name, p.example)).collect();
            let remedy = format!("add it, for instance `{}`", example.join(", "));
            return Err(Refusal::new(first[0].name, "is missing", remedy));
        };
        match present.next() {
            None => Ok(way),
            Some((_, other)) => {
                let words =
                    |way: &&[Parameter]| way.iter().map(|p| format!("`{}`", p.name)).collect::<Vec<_>>().join(" and ");
                let all: Vec<String> = self.ways.iter().map(words).collect();
                let remedy = format!("give either {}", all.join(", or "));
                Err(Refusal::new(other.name, format!("cannot be combined with `{}`", one.name), remedy))
            }
        }
    }

    /// What it makes of these parameters, each by its name.
    ///
    /// # Errors
    /// Parameters that are unknown, missing or out of range, and what `make` refuses.
    pub fn with<'a>(&self, given: impl IntoIterator<Item = (&'a str, Given<'a>)>) -> Result<T, Refusal> {
        let given: Vec<(&str, Given<'_>)> = given.into_iter().collect();
        if let Some((name, _)) = given.iter().find(|(name, _)| self.parameters().all(|p| p.name != *name)) {
            let known: Vec<&str> = self.parameters().map(|p| p.name).collect();
            let message = format!("has no parameter {name}");
            return Err(Refusal::new("law", message, format!("it has {}", known.join(", "))));
        }
        let way = self.way(|name| given.iter().any(|(other, _)| *other == name))?;
        let mut values = Vec::new();
        for parameter in self.ways[way] {
            let Parameter { name, example, .. } = *parameter;
            let Some((_, value)) = given.iter().find(|(other, _)| *other == name) else {
                return Err(Refusal::new(name, "is missing", format!("add it, for instance `{name} = {example}`")));
            };
            let is_list = matches!(value, Given::List(_));
            if is_list != parameter.is_list() || value.list().is_empty() {
                let what =
                    if parameter.is_list() { "must be a list of one number or more" } else { "must be a number" };
                return Err(Refusal::new(name, what, format!("write for instance {example}")));
            }
            if let Some(bad) = value.list().iter().find(|value| !parameter.values.contain(**value)) {
                let message = format!("{bad} is out of range");
                return Err(Refusal::new(name, message, format!("write for instance {example}")));
            }
            values.push(*value);
        }
        (self.make)(way, &values)
    }

    /// What it makes of the examples of the first way.
    ///
    /// # Errors
    /// The errors of [`Self::with`]: a row whose examples are refused is wrong.
    pub fn of_examples(&self) -> Result<T, Refusal> {
        self.with(self.ways.first().copied().unwrap_or_default().iter().map(|p| (p.name, p.example)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Unit, Values, list, number};

    const ROW: Row<f64> = Row {
        name: "sum",
        about: "A sum, or a list of summands.",
        ways: &[
            &[number("a", "One.", Unit::Number, Values::Positive, 2.0)],
            &[list("all", "All.", Unit::Number, Values::NotNegative, &[1.0, 0.0])],
        ],
        make: |_, given| Ok(given[0].list().iter().sum()),
    };

    #[test]
    fn values_are_refused_by_the_name_of_their_parameter() {
        let [a, all] = [Given::Number(3.0), Given::List(&[1.0, 2.5])];
        assert_eq!((ROW.with([("a", a)]), ROW.with([("all", all)]), ROW.of_examples()), (Ok(3.0), Ok(3.5), Ok(2.0)));
        let refused = |given: &[(&'static str, Given<'static>)]| ROW.with(given.iter().copied()).unwrap_err();
        assert_eq!(refused(&[]).parameter, "a");
        assert_eq!(refused(&[("a", a), ("all", all)]).parameter, "all");
        assert_eq!(refused(&[("b", a)]).parameter, "law");
        for wrong in [Given::Number(0.0), Given::Number(f64::NAN), Given::List(&[1.0])] {
            assert_eq!(refused(&[("a", wrong)]).parameter, "a", "{wrong}");
        }
        for wrong in [Given::Number(1.0), Given::List(&[]), Given::List(&[1.0, -0.5])] {
            assert_eq!(refused(&[("all", wrong)]).parameter, "all", "{wrong}");
        }
        assert_eq!(refused(&[("all", Given::List(&[]))]).remedy, "write for instance [1.0, 0.0]");
    }
}
