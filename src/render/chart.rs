//! Line charts, as SVG and as pixels.

use super::{Image, RenderError, font};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A line with a mark at each of its points.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Points in the units of the axes, in order.
    pub points: Vec<(f64, f64)>,
    /// Red, green, blue.
    pub colour: [u8; 3],
}

/// A chart of several lines over a common horizontal axis.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Heading.
    pub title: String,
    /// What lies along the horizontal and the vertical axis.
    pub labels: [String; 2],
    /// Ends of the horizontal axis.
    pub x_range: [f64; 2],
    /// Places with a label on the horizontal axis.
    pub x_ticks: Vec<(f64, String)>,
    /// Ends of the vertical axis.
    pub y_range: [f64; 2],
    /// Lines, the first at the top of the legend.
    pub series: Vec<Series>,
}

/// Pixels of a chart.
const SIZE: (u32, u32) = (960, 600);
/// Pixels of the drawing for one of the picture, in each direction.
const OVERSAMPLING: u32 = 3;
const TEXT: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(225, 225, 225);

impl Chart {
    /// The chart as an SVG document.
    ///
    /// # Errors
    /// If the axes have no extent.
    pub fn to_svg(&self) -> Result<String, RenderError> {
        let mut svg = String::new();
        self.draw(SVGBackend::with_string(&mut svg, SIZE).into_drawing_area(), 1)?;
        Ok(svg)
    }

    /// The chart as a picture.
    ///
    /// # Errors
    /// If the axes have no extent.
    pub fn to_image(&self) -> Result<Image, RenderError> {
        // Drawn larger and made small again: plotters sets letters and lines on whole pixels.
        let large = (SIZE.0 * OVERSAMPLING, SIZE.1 * OVERSAMPLING);
        let mut pixels = vec![255; 3 * large.0 as usize * large.1 as usize];
        self.draw(BitMapBackend::with_buffer(&mut pixels, large).into_drawing_area(), OVERSAMPLING)?;
        Ok(Image::from_rgb(large.0, large.1, &pixels).reduced(OVERSAMPLING))
    }

    fn draw<B: DrawingBackend>(&self, area: DrawingArea<B, Shift>, scale: u32) -> Result<(), RenderError> {
        let has_extent = |[low, high]: [f64; 2]| low.is_finite() && high.is_finite() && low < high;
        if !font::register() || !has_extent(self.x_range) || !has_extent(self.y_range) {
            return Err(RenderError::Chart("an axis has no extent".into()));
        }
        self.try_draw(&area, scale).map_err(|error| RenderError::Chart(error.to_string()))
    }

    fn try_draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        scale: u32,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let text = |size: u32| (font::NAME, size * scale).into_font().color(&TEXT);
        let length = scale as i32;
        area.fill(&WHITE)?;
        let [x0, x1] = self.x_range;
        let [y0, y1] = self.y_range;
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, text(22))
            .margin(14 * scale)
            .margin_right(24 * scale)
            .x_label_area_size(if self.labels[0].is_empty() { 30 } else { 56 } * scale)
            .y_label_area_size(70 * scale)
            .build_cartesian_2d(x0..x1, y0..y1)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .x_labels(0)
            .y_labels(11)
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(scale))
            .y_label_style(text(14))
            .y_desc(&self.labels[1])
            .axis_desc_style(text(15))
            .axis_style(TEXT.stroke_width(scale))
            .set_all_tick_mark_size(5 * scale)
            .draw()?;
        for (x, _) in &self.x_ticks {
            chart.draw_series(LineSeries::new([(*x, y0), (*x, y1)], GRID.stroke_width(scale)))?;
        }
        for series in &self.series {
            let [r, g, b] = series.colour;
            let colour = RGBColor(r, g, b);
            let marks = series.points.iter().map(|&p| Circle::new(p, 3 * scale, colour.filled()));
            chart
                .draw_series(LineSeries::new(series.points.iter().copied(), colour.stroke_width(2 * scale)))?
                .label(&series.name)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18 * length, y)], colour.stroke_width(2 * scale))
                });
            chart.draw_series(marks)?;
        }
        if self.series.len() > 1 {
            chart
                .configure_series_labels()
                .label_font(text(14))
                .legend_area_size(24 * scale)
                .margin(6 * scale)
                .background_style(WHITE.mix(0.85))
                .border_style(GRID)
                .position(SeriesLabelPosition::UpperLeft)
                .draw()?;
        }
        self.draw_x_axis(area, &chart, scale)?;
        area.present()
    }

    /// Labels of the horizontal axis, which are ours to place.
    fn draw_x_axis<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        chart: &ChartContext<B, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
        scale: u32,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let centred = Pos::new(HPos::Center, VPos::Top);
        let style = |size: u32| (font::NAME, size * scale).into_font().color(&TEXT).pos(centred);
        for (x, label) in &self.x_ticks {
            let (px, py) = chart.backend_coord(&(*x, self.y_range[0]));
            area.draw_text(label, &style(14), (px, py + 8 * scale as i32))?;
        }
        let middle = (self.x_range[0] + self.x_range[1]) / 2.0;
        let (px, py) = chart.backend_coord(&(middle, self.y_range[0]));
        area.draw_text(&self.labels[0], &style(15), (px, py + 32 * scale as i32))
    }
}

/// Places 1, 2 and 5 times powers of ten from `low` to `high`, as (log₁₀, label).
pub fn log_ticks(low: f64, high: f64, label: impl Fn(f64) -> String) -> Vec<(f64, String)> {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let places = (first..=last).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(power)));
    let within = places.filter(|place| (low..=high).contains(place));
    within.map(|place| (place.log10(), label(place))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let series = |name: &str, colour| Series {
            name: name.into(),
            points: vec![(0.0, 1.0), (1.0, 2.0), (2.0, 1.5)],
            colour,
        };
        Chart {
            title: "Title".into(),
            labels: ["across".into(), "up".into()],
            x_range: [-0.5, 2.5],
            x_ticks: vec![(0.0, "zero".into()), (1.0, "one".into())],
            y_range: [0.0, 3.0],
            series: vec![series("first", [255, 0, 0]), series("second", [0, 0, 255])],
        }
    }

    #[test]
    fn svg_has_every_label() {
        let svg = chart().to_svg().unwrap();
        for text in ["Title", "across", "up", "zero", "one", "first", "second"] {
            assert!(svg.contains(&format!("\n{text}\n")), "{text} in {svg}");
        }
    }

    #[test]
    fn pixels_have_the_lines_on_white() {
        let image = chart().to_image().unwrap();
        assert_eq!(image.pixel(0, 0), Some([255; 4]));
        let blue = image.rgba().chunks_exact(4).filter(|p| p[2] > 200 && p[0] < 60).count();
        assert!(blue > 500, "{blue} blue pixels");
        let dark = image.rgba().chunks_exact(4).filter(|p| p[0] < 90 && p[1] < 90 && p[2] < 90).count();
        assert!(dark > 500, "{dark} pixels of text");
    }

    #[test]
    fn an_axis_without_extent_is_refused() {
        assert!(Chart { y_range: [1.0, 1.0], ..chart() }.to_svg().is_err());
        assert!(Chart { x_range: [0.0, f64::NAN], ..chart() }.to_image().is_err());
    }

    #[test]
    fn ticks_of_a_logarithmic_axis() {
        let ticks = log_ticks(90.0, 2000.0, |x| format!("{x}"));
        let labels: Vec<&str> = ticks.iter().map(|t| t.1.as_str()).collect();
        assert_eq!(labels, ["100", "200", "500", "1000", "2000"]);
    }
}
