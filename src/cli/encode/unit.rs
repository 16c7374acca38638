//! Lengths with units.

use clap::builder::{PossibleValuesParser, TypedValueParser};

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    name: &'static str,
    metres: f64,
}

impl Unit {
    pub const METRE: Self = Self { name: "m", metres: 1.0 };
    /// The feet are international ones, of 0.3048 m.
    const ALL: [Self; 7] = [
        Self::METRE,
        Self { name: "cm", metres: 0.01 },
        Self { name: "mm", metres: 1e-3 },
        Self { name: "um", metres: 1e-6 },
        Self { name: "km", metres: 1e3 },
        Self { name: "in", metres: 0.0254 },
        Self { name: "ft", metres: 0.3048 },
    ];

    pub fn name(self) -> &'static str {
        self.name
    }

    /// Its length.
    pub fn metres(self) -> f64 {
        self.metres
    }

    fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.name == name)
    }
}

pub fn unit_parser() -> impl TypedValueParser<Value = Unit> {
    PossibleValuesParser::new(Unit::ALL.map(Unit::name))
        .try_map(|name| Unit::find(&name).ok_or("unknown unit"))
}

/// A length in some unit, or in that of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    pub number: f64,
    pub unit: Option<Unit>,
}

impl Length {
    /// A number above 0 and perhaps a unit, as in `1mm` and `1e-3 m`.
    pub fn parse(text: &str) -> Option<Self> {
        let number = |text: &str| text.trim_end().parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
        let with =
            |unit: Unit| Some(Self { number: number(text.strip_suffix(unit.name)?)?, unit: Some(unit) });
        Unit::ALL.into_iter().find_map(with).or_else(|| Some(Self { number: number(text)?, unit: None }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_units_or_none() {
        for (text, number, unit) in [
            ("1mm", 1.0, Some("mm")),
            ("0.5 cm", 0.5, Some("cm")),
            ("1e-3m", 1e-3, Some("m")),
            ("2in", 2.0, Some("in")),
            ("3", 3.0, None),
            ("1e-3", 1e-3, None),
        ] {
            let expected = Length { number, unit: unit.and_then(Unit::find) };
            assert_eq!(Length::parse(text), Some(expected), "{text}");
        }
        for wrong in ["", "mm", "0mm", "-1mm", "1parsec", "1 mm mm", "inf", "nanm"] {
            assert_eq!(Length::parse(wrong), None, "{wrong}");
        }
    }
}
