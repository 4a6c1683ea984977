use super::frame::{Frame, Pixel};
use super::items::{Figure, Picture};
use super::{Mark, Style, text};
use crate::geometry::{Aabb, Point, Vector};
use crate::world::World;

/// Minimum gap between two panels, relative to the larger side of the largest.
const GAP: f64 = 0.14;
/// Maximum number of lines of a panel's title.
const MOST_LINES: usize = 8;

impl Picture {
    /// Combines several pictures into one, in rows of `columns` from the upper left, each with its title
    /// below it, in several lines if necessary. They share scale, legend and time. Captions are omitted.
    pub fn panels(panels: &[Self], columns: usize) -> Self {
        let columns = columns.clamp(1, panels.len().max(1));
        let rows = panels.len().div_ceil(columns);
        let extent = panels.iter().fold(Vector::zeros(), |most, panel| most.sup(&panel.region().size()));
        let titles = Titles::of(panels, extent, columns, rows);
        let gap = titles.gap;
        let step = extent + Vector::repeat(gap);
        let size = Vector::new(step.x * columns as f64, step.y * rows as f64);
        let mut all = Self::new(&World::empty(size.x, size.y));
        all.to_scale = panels.iter().all(|panel| panel.to_scale);
        all.first_plan = panels.iter().find_map(Self::plan).cloned().map(Box::new);
        for (index, panel) in panels.iter().enumerate() {
            let (column, row) = (index % columns, rows - 1 - index / columns);
            let corner = Vector::new(column as f64 * step.x, row as f64 * step.y);
            let spare = step - panel.region().size();
            let shift =
                corner + Vector::new(0.5 * spare.x, titles.below * spare.y) - panel.region().min.coords;
            all.take(panel, shift, &titles);
        }
        all
    }

    /// Adds the content of another picture, shifted by `shift`, with its title below it.
    fn take(&mut self, panel: &Self, shift: Vector, titles: &Titles) {
        let bounds = panel.region();
        let (min, max) = (bounds.min + shift, bounds.max + shift);
        let corners = [min, Point::new(max.x, min.y), max, Point::new(min.x, max.y)];
        self.polygon(corners, Style::aid().opacity(0.5));
        self.take_ground(panel, shift);
        self.world.walls.extend(panel.world.walls.iter().copied().map(|mut wall| {
            wall.line.a += shift;
            wall.line.b += shift;
            wall
        }));
        self.world.objects.extend(panel.world.objects.iter().cloned().map(|mut object| {
            object.pose.x += shift.x;
            object.pose.y += shift.y;
            object
        }));
        self.items.extend(panel.items.iter().cloned().map(|mut item| {
            item.figure.shift(shift);
            item
        }));
        let lines = titles.lines(panel);
        let upper = 0.5 * (lines.len() as f64 - 1.0);
        for (number, line) in lines.into_iter().enumerate() {
            let below = 0.45 * titles.gap + (number as f64 - upper) * text::LINE / titles.scale;
            let middle = Point::new(0.5 * (min.x + max.x), min.y - below);
            self.add(Figure::Mark { mark: None::<Mark>, position: middle, text: Some(line) }, Style::aid());
        }
    }

    /// Adds the floor of another picture, shifted by `shift`, if it has water or a hill with a surface.
    fn take_ground(&mut self, panel: &Self, shift: Vector) {
        let World { floor, water_level, .. } = panel.world;
        let terrain = panel.world.terrain.clone().filter(|terrain| terrain.surface.is_some());
        if water_level.is_some() || terrain.is_some() {
            let ground = World { floor, terrain, water_level, ..World::empty(0.0, 0.0) };
            self.grounds.push((ground, shift));
        }
        self.grounds.extend(panel.grounds.iter().cloned().map(|(ground, moved)| (ground, moved + shift)));
    }
}

/// Room for the titles of panels.
struct Titles {
    /// Gap between panels (m).
    gap: f64,
    /// Part of the gap that is below a panel: all of it but half a line.
    below: f64,
    /// Pixels per metre of the page.
    scale: f64,
    /// Width of a title (pixels).
    room: f64,
}

impl Titles {
    /// With as many lines as the longest title takes.
    fn of(panels: &[Picture], extent: Vector, columns: usize, rows: usize) -> Self {
        let titles = |lines: usize| {
            let gap = gap(extent, columns, rows, lines);
            let size =
                (extent + Vector::repeat(gap)).component_mul(&Vector::new(columns as f64, rows as f64));
            let frame = Frame::around(Aabb { min: Point::origin(), max: Point::from(size) }, Pixel::origin());
            let below = (lines as f64 + 0.5) / (lines as f64 + 1.0);
            Self { gap, below, scale: frame.scale, room: frame.length(extent.x + gap) - 0.5 * text::SIZE }
        };
        let fits = |lines: &usize| {
            let titles = titles(*lines);
            panels.iter().all(|panel| titles.lines(panel).len() <= *lines)
        };
        titles((1..MOST_LINES).find(fits).unwrap_or(MOST_LINES))
    }

    /// The lines of a panel's title.
    fn lines(&self, panel: &Picture) -> Vec<String> {
        let title = panel.title.as_deref().unwrap_or_default();
        text::wrapped(&text::clean(title), text::SIZE, self.room)
    }
}

/// Gap between panels (m) that has room for titles of a number of lines on the page, and for the symbols at the
/// panels' edges.
fn gap(extent: Vector, columns: usize, rows: usize, lines: usize) -> f64 {
    let title = (1 + lines) as f64 * text::LINE;
    // With a gap g, the page's scale is room / (n (extent + g)); g is as many metres as the title is pixels there.
    let needed = |room: f64, extent: f64, n: usize| {
        let titles = (title * n as f64).min(0.5 * room);
        titles * extent / (room - titles)
    };
    let across = needed(Frame::WIDEST, extent.x, columns);
    (GAP * extent.max()).max(across).max(needed(Frame::TALLEST, extent.y, rows))
}

impl Figure {
    fn shift(&mut self, by: Vector) {
        let shift = |points: &mut [Point]| points.iter_mut().for_each(|point| *point += by);
        match self {
            Figure::Disc { centre, .. } => *centre += by,
            Figure::Mark { position, .. } => *position += by,
            Figure::Polygon(points) | Figure::Points(points) | Figure::Line { points, .. } => shift(points),
            Figure::Moving(shapes) => shapes.iter_mut().for_each(|(_, points)| shift(points)),
            Figure::Robot { poses, .. } => poses.iter_mut().for_each(|(_, pose)| {
                pose.x += by.x;
                pose.y += by.y;
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{HeightField, Terrain};

    fn titled(title: &str) -> Picture {
        let mut picture = Picture::new(&World::empty(2.0, 1.0));
        picture.title(title);
        picture
    }

    #[test]
    fn the_plan_is_the_first_panel_in_the_world_s_coordinates() {
        let (plan, mut chart) = (titled("plan"), titled("chart"));
        chart.without_scale();
        let title =
            |panels: &[Picture]| Picture::panels(panels, 1).plan().and_then(|plan| plan.title.clone());
        assert_eq!(title(&[chart.clone(), plan.clone(), titled("another")]).as_deref(), Some("plan"));
        assert_eq!(title(&[Picture::panels(&[plan], 1), chart.clone()]).as_deref(), Some("plan"));
        assert_eq!(title(&[chart]), None);
    }

    #[test]
    fn panels_keep_their_water_and_hills() {
        let area = Aabb::new(Point::origin(), Point::new(2.0, 2.0));
        let hill = HeightField::from_fn(5, 5, area, |at| 0.1 * at.x).unwrap();
        let terrain = Some(Terrain::new("hill", hill));
        let world = World { terrain, water_level: Some(0.1), ..World::empty(2.0, 2.0) };
        let panels = [Picture::new(&world), Picture::new(&world)];
        let contours = |picture: &Picture| picture.to_svg().matches("stroke-opacity=\"0.45\"").count();
        assert_eq!(contours(&Picture::panels(&panels, 2)), 2 * contours(&panels[0]));
        assert!(Picture::panels(&panels, 2).to_svg().matches("contour lines").count() == 1);
    }

    #[test]
    fn long_titles_of_panels_have_several_lines_and_lose_nothing() {
        let long = ["searched"; 9].join(" ");
        let text = Picture::panels(&[titled("short"), titled(&long), titled(&long)], 3).to_svg();
        assert_eq!((text.matches("short").count(), text.matches("searched").count()), (1, 18));
        assert!(text.matches("<text").count() > 5, "{text}");
    }

    #[test]
    fn titles_have_a_line_between_panels() {
        for (extent, columns, rows) in [((3.0, 4.0), 4, 3), ((6.0, 1.0), 1, 2), ((257.0, 257.0), 2, 2)] {
            let extent = Vector::new(extent.0, extent.1);
            let gap = gap(extent, columns, rows, 1);
            let size =
                (extent + Vector::repeat(gap)).component_mul(&Vector::new(columns as f64, rows as f64));
            let page = Frame::around(Aabb { min: Point::origin(), max: Point::from(size) }, Point::origin());
            assert!(page.length(gap) > 2.0 * text::LINE - 1e-6, "{} pixels", page.length(gap));
        }
    }
}
