//! Losses as people read them.

use super::{Loss, LossKind, Losses};
use std::fmt;

impl fmt::Display for Losses {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, loss) in self.iter().enumerate() {
            let newline = if k > 0 { "\n" } else { "" };
            write!(f, "{newline}{loss}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Loss {
    /// One sentence without a full stop: `12 of 40 triangles collapsed: `-q 16` keeps them`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what())?;
        if let Some(error) = self.largest_error {
            write!(f, ", by at most {}", Short(error))?;
        }
        if let Some(edges) = self.largest_error_in_edges {
            write!(f, ", {} of an edge", Short(edges))?;
        }
        if !self.remedy.is_empty() {
            write!(f, ": {}", self.remedy)?;
        }
        Ok(())
    }
}

impl Loss {
    /// What happens to what and to how many.
    fn what(&self) -> String {
        let subject = &self.subject;
        match self.kind {
            LossKind::Dropped => format!("left out: {subject}{}", self.count_behind()),
            LossKind::PositionsRounded => format!("{} rounded{}", self.counted("position"), to(subject)),
            LossKind::TrianglesCollapsed => format!("{} collapsed", self.counted("triangle")),
            LossKind::TrianglesTurned => format!("{} turned over", self.counted("triangle")),
            LossKind::ValuesRounded => format!("{subject}: {} rounded", self.counted("value")),
            LossKind::IdentifiersChanged => format!("{subject}: {} changed", self.counted("identifier")),
            LossKind::ValuesConverted => format!("{subject}: {} converted", self.counted("value")),
            LossKind::ValuesFilled => {
                format!("{subject}: {} made up where there was none", self.counted("value"))
            }
            LossKind::NamesChanged if self.count.is_none() => format!("written by another name: {subject}"),
            LossKind::NamesChanged => format!("{subject}: {} changed", self.counted("name")),
            LossKind::PolygonsTriangulated => {
                format!("{} cut into triangles{}", self.counted("polygon"), behind(subject))
            }
            LossKind::VerticesJoined => format!("{} joined with others", self.counted("vertex")),
            LossKind::VerticesSplit => format!("{} repeated", self.counted("vertex")),
            LossKind::Reordered => {
                format!("vertices and triangles in another order{}", in_parentheses(subject))
            }
            LossKind::Coarser => format!("coarser than the whole stream{}", in_parentheses(subject)),
        }
    }

    /// `1 value`, `12 of 40 values`, or `values` if nobody counted them.
    fn counted(&self, one: &str) -> String {
        let many = if one == "vertex" { "vertices".to_owned() } else { format!("{one}s") };
        match (self.count, self.total) {
            (Some(count), Some(total)) => format!("{count} of {total} {many}"),
            (Some(1), None) => format!("1 {one}"),
            (Some(count), None) => format!("{count} {many}"),
            (None, _) => many,
        }
    }

    /// ` (12)`, ` (12 of 40)` or nothing.
    fn count_behind(&self) -> String {
        match (self.count, self.total) {
            (Some(count), Some(total)) => format!(" ({count} of {total})"),
            (Some(count), None) => format!(" ({count})"),
            (None, _) => String::new(),
        }
    }
}

fn to(subject: &str) -> String {
    if subject.is_empty() { String::new() } else { format!(" to {subject}") }
}

fn behind(subject: &str) -> String {
    if subject.is_empty() { String::new() } else { format!(" {subject}") }
}

fn in_parentheses(subject: &str) -> String {
    if subject.is_empty() { String::new() } else { format!(" ({subject})") }
}

/// Two digits that count; the exponent only where zeros would be many.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded: f64 = format!("{:.1e}", self.0).parse().unwrap_or(self.0);
        if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) {
            write!(f, "{rounded}")
        } else {
            write!(f, "{rounded:e}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Stage;
    use super::*;

    #[test]
    fn sentences_say_what_how_many_and_how_much() {
        let loss = |kind, subject: &str| Loss::new(Stage::Encoding, kind, subject);
        for (loss, sentence) in [
            (loss(LossKind::Dropped, "isolated vertices").count(3), "left out: isolated vertices (3)"),
            (
                loss(LossKind::TrianglesCollapsed, "").count(12).of(40).remedy("`-q 16` keeps them"),
                "12 of 40 triangles collapsed: `-q 16` keeps them",
            ),
            (
                loss(LossKind::PositionsRounded, "").at_most(0.000_012_34),
                "positions rounded, by at most 1.2e-5",
            ),
            (
                loss(LossKind::PositionsRounded, "float32").at_most(0.25),
                "positions rounded to float32, by at most 0.25",
            ),
            (loss(LossKind::ValuesRounded, "vn").at_most(12.34), "vn: values rounded, by at most 12"),
            (loss(LossKind::NamesChanged, "heat (_heat)"), "written by another name: heat (_heat)"),
            (loss(LossKind::Coarser, "level 3 of 9"), "coarser than the whole stream (level 3 of 9)"),
        ] {
            assert_eq!(loss.to_string(), sentence);
        }
    }
}
