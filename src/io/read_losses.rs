//! The report of a reader as a list of losses.

use super::mesh_file::ReadReport;
use crate::losses::{Loss, LossKind, Losses, Stage};

impl ReadReport {
    /// What the mesh lacks of its file.
    pub fn losses(&self) -> Losses {
        let mut losses = Losses::default();
        let mut count = |kind: LossKind, what: &str, count: usize| {
            if count > 0 {
                losses.push(loss(kind, what).count(count));
            }
        };
        count(LossKind::PolygonsTriangulated, "", self.polygons_triangulated);
        count(LossKind::PolygonsTriangulated, "that overlap", self.polygons_overlapping);
        count(LossKind::Dropped, "faces of fewer than three corners", self.faces_skipped);
        count(LossKind::Dropped, "points flagged as withheld", self.points_withheld);
        count(LossKind::Dropped, "points above others, or not wanted", self.points_left_out);
        count(LossKind::VerticesJoined, "", self.corners_welded);
        count(LossKind::ValuesConverted, "colours of 8 bits in fields of 16", self.colours_of_8_bits);
        self.renamed.iter().for_each(|name| losses.push(loss(LossKind::NamesChanged, name)));
        self.ignored.iter().for_each(|name| losses.push(loss(LossKind::Dropped, name)));
        losses
    }
}

fn loss(kind: LossKind, subject: &str) -> Loss {
    Loss::new(Stage::Reading, kind, subject)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_of_a_report_is_a_loss() {
        assert!(ReadReport::default().losses().is_empty());
        let report = ReadReport {
            polygons_triangulated: 1,
            polygons_overlapping: 1,
            faces_skipped: 2,
            corners_welded: 3,
            points_left_out: 4,
            points_withheld: 5,
            colours_of_8_bits: 6,
            renamed: vec!["a b (a_b)".into()],
            ignored: vec!["l".into(), "p".into()],
        };
        assert_eq!(report.losses().len(), 10);
        let sentence = report.losses().to_string();
        assert!(sentence.contains("left out: faces of fewer than three corners (2)"), "{sentence}");
        assert!(sentence.contains("a b (a_b)"), "{sentence}");
        assert!(sentence.contains("colours of 8 bits in fields of 16"), "{sentence}");
        assert!(sentence.contains("left out: p"), "{sentence}");
        assert!(sentence.contains("1 polygon cut into triangles that overlap"), "{sentence}");
    }
}
