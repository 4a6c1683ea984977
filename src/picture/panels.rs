use super::items::{Figure, Picture};
use super::{Mark, Style};
use crate::geometry::{Point, Vector};
use crate::world::World;

/// What is left between two panels, as a share of the larger side of the largest.
const GAP: f64 = 0.14;

impl Picture {
    /// Combines several pictures into one, in rows of `columns` from the upper left, each with its title
    /// below it. They share scale, legend and time. Water, hills and captions are omitted.
    pub fn panels(panels: &[Self], columns: usize) -> Self {
        let columns = columns.clamp(1, panels.len().max(1));
        let rows = panels.len().div_ceil(columns);
        let extent = panels.iter().fold(Vector::zeros(), |most, panel| most.sup(&panel.region().size()));
        let gap = GAP * extent.max();
        let step = extent + Vector::repeat(gap);
        let size = Vector::new(step.x * columns as f64, step.y * rows as f64);
        let mut all = Self::new(&World::empty(size.x, size.y));
        all.to_scale = panels.iter().all(|panel| panel.to_scale);
        for (index, panel) in panels.iter().enumerate() {
            let (column, row) = (index % columns, rows - 1 - index / columns);
            let corner = Vector::new(column as f64 * step.x, row as f64 * step.y);
            let spare = step - panel.region().size();
            let shift = corner + Vector::new(0.5 * spare.x, 0.65 * spare.y) - panel.region().min.coords;
            all.take(panel, shift, 0.5 * gap);
        }
        all
    }

    /// Adds the content of another picture, shifted by `shift`, with its title `below` metres below it.
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
            let middle = Point::new(0.5 * (min.x + max.x), min.y - 0.7 * below);
            self.add(
                Figure::Mark { mark: None::<Mark>, position: middle, text: Some(title.clone()) },
                Style::aid(),
            );
        }
    }
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
