use super::frame::Frame;
use super::items::{Figure, Picture};
use super::{Mark, Style, text};
use crate::geometry::{Point, Vector};
use crate::world::World;

/// Minimum gap between two panels, relative to the larger side of the largest.
const GAP: f64 = 0.14;
/// Minimum gap between two panels (pixels): a line of text, and the symbols at the panels' edges.
const TITLE: f64 = 2.0 * text::LINE;

impl Picture {
    /// Combines several pictures into one, in rows of `columns` from the upper left, each with its title
    /// below it. They share scale, legend and time. Water, hills and captions are omitted.
    pub fn panels(panels: &[Self], columns: usize) -> Self {
        let columns = columns.clamp(1, panels.len().max(1));
        let rows = panels.len().div_ceil(columns);
        let extent = panels.iter().fold(Vector::zeros(), |most, panel| most.sup(&panel.region().size()));
        let gap = gap(extent, columns, rows);
        let step = extent + Vector::repeat(gap);
        let size = Vector::new(step.x * columns as f64, step.y * rows as f64);
        let mut all = Self::new(&World::empty(size.x, size.y));
        all.to_scale = panels.iter().all(|panel| panel.to_scale);
        for (index, panel) in panels.iter().enumerate() {
            let (column, row) = (index % columns, rows - 1 - index / columns);
            let corner = Vector::new(column as f64 * step.x, row as f64 * step.y);
            let spare = step - panel.region().size();
            let shift = corner + Vector::new(0.5 * spare.x, 0.75 * spare.y) - panel.region().min.coords;
            all.take(panel, shift, 0.45 * gap);
        }
        all
    }

    /// Adds the content of another picture, shifted by `shift`, with the middle of its title `below` metres below it.
    fn take(&mut self, panel: &Self, shift: Vector, below: f64) {
        let bounds = panel.region();
        let (min, max) = (bounds.min + shift, bounds.max + shift);
        let corners = [min, Point::new(max.x, min.y), max, Point::new(min.x, max.y)];
        self.polygon(corners, Style::aid().opacity(0.5));
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
        if let Some(title) = &panel.title {
            let middle = Point::new(0.5 * (min.x + max.x), min.y - below);
            self.add(
                Figure::Mark { mark: None::<Mark>, position: middle, text: Some(title.clone()) },
                Style::aid(),
            );
        }
    }
}

/// Gap between panels (m) that has room for their titles on the page.
fn gap(extent: Vector, columns: usize, rows: usize) -> f64 {
    // With a gap g, the page's scale is room / (n (extent + g)); g is as many metres as TITLE is pixels there.
    let needed = |room: f64, extent: f64, n: usize| {
        let titles = (TITLE * n as f64).min(0.5 * room);
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
    use crate::geometry::Aabb;

    #[test]
    fn titles_have_a_line_between_panels() {
        for (extent, columns, rows) in [((3.0, 4.0), 4, 3), ((6.0, 1.0), 1, 2), ((257.0, 257.0), 2, 2)] {
            let extent = Vector::new(extent.0, extent.1);
            let gap = gap(extent, columns, rows);
            let size =
                (extent + Vector::repeat(gap)).component_mul(&Vector::new(columns as f64, rows as f64));
            let page = Frame::around(Aabb { min: Point::origin(), max: Point::from(size) }, Point::origin());
            assert!(page.length(gap) > TITLE - 1e-6, "{} pixels", page.length(gap));
        }
    }
}
