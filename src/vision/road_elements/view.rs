use std::ops::Range;

use crate::geometry::{Point, Vector};
use crate::vision::GrayView;
use crate::vision::lane_markings::{Projection, RoadAhead, RoadCamera};

/// Size of a cell of the straightened picture (m).
pub(super) const CELL: f64 = 0.01;
/// Distance from the camera to the first row along the road (m).
const NEAR: f64 = 0.10;
/// Number of rows.
pub(super) const ROWS: usize = 150;
/// Number of columns to each side of the centre line.
const SIDE: usize = 95;
/// Number of columns.
pub(super) const COLUMNS: usize = 2 * SIDE + 1;
/// Share of the road that is less bright than paint: a single solid edge line covers 2 %.
const UNPAINTED: f64 = 0.985;
/// Share of the road that is darker than a typical floor, where boxes may hide most of it.
const FLOOR: f64 = 0.3;
/// Smallest contrast of paint (gray levels): below it, noise would be found.
const LEAST: f32 = 25.0;
/// Share of an image's brightness of paint in the running mean.
const SHARE: f32 = 0.3;

/// The ground along the road, straightened: rows run along the road, columns to the left.
#[derive(Debug, Clone)]
pub(super) struct RoadView {
    /// The camera at the scale of the rules.
    camera: RoadCamera,
    gray: Vec<f32>,
    /// Sums over the rows before, column by column.
    sums: Vec<f32>,
    /// Rows of each column that are in view.
    seen: Vec<Range<usize>>,
    /// Length of ground that a pixel covers at each row (m).
    depth: Vec<f64>,
    /// The same in cells, rounded up.
    blur: Vec<usize>,
    /// Distance of the camera to the left of the road's centre line (m).
    left: f64,
    /// Brightness of the floor and of paint.
    floor: f32,
    paint: f32,
}

/// Column at a distance to the left of the road's centre line (m).
pub(super) fn column(left: f64) -> usize {
    (SIDE as f64 + (left / CELL).round()).clamp(0.0, (COLUMNS - 1) as f64) as usize
}

/// Distance of a column to the left of the road's centre line (m).
pub(super) fn left(column: usize) -> f64 {
    CELL * (column as f64 - SIDE as f64)
}

/// Columns between two distances to the left of the road's centre line (m).
pub(super) fn columns(from: f64, to: f64) -> Range<usize> {
    column(from)..column(to) + 1
}

impl RoadView {
    pub(super) fn new(camera: RoadCamera) -> Self {
        Self {
            camera,
            gray: vec![0.0; ROWS * COLUMNS],
            sums: vec![0.0; (ROWS + 1) * COLUMNS],
            seen: vec![0..0; COLUMNS],
            depth: vec![0.0; ROWS],
            blur: vec![0; ROWS],
            left: 0.0,
            floor: 0.0,
            paint: 0.0,
        }
    }

    /// Straightens an image.
    pub(super) fn straighten(&mut self, image: GrayView<'_>, road: &RoadAhead, pitch: f64) {
        let projection = self.projection(image, pitch);
        let (centre, aside) = road.at(self.camera.ahead);
        self.left = -centre.coords.dot(&aside);
        self.seen.fill(ROWS..ROWS);
        for row in 0..ROWS {
            let (centre, aside) = road.at(self.ahead(row));
            let line = |left: f64| projection.of(centre + aside * left).map(|(_, row)| row);
            let (next, _) = road.at(self.ahead(row) + CELL);
            let further = projection.of(next).map(|(_, row)| row);
            self.depth[row] = match (line(0.0), further) {
                (Some(near), Some(far)) => CELL / (near - far).abs().max(1e-3),
                _ => CELL,
            };
            self.blur[row] = (self.depth[row] / CELL).ceil() as usize;
            for column in 0..COLUMNS {
                let seen = projection.of(centre + aside * left(column)).and_then(|at| sample(image, at));
                let range = &mut self.seen[column];
                match seen {
                    Some(gray) => {
                        self.gray[row * COLUMNS + column] = gray;
                        // A range begins with its first row, and goes on as long as it is unbroken.
                        if range.start == ROWS {
                            *range = row..row + 1;
                        } else if range.end == row {
                            range.end = row + 1;
                        }
                    }
                    None => self.gray[row * COLUMNS + column] = 0.0,
                }
            }
        }
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                let at = row * COLUMNS + column;
                self.sums[at + COLUMNS] = self.sums[at] + self.gray[at];
            }
        }
        self.expose(road.edge);
    }

    /// Measures the brightness of floor and paint on the road.
    fn expose(&mut self, edge: f64) {
        let mut histogram = [0_u32; 256];
        let mut count = 0;
        for column in columns(-edge - 0.02, edge + 0.02) {
            for row in self.seen[column].clone() {
                histogram[(self.gray[row * COLUMNS + column] as usize).min(255)] += 1;
                count += 1;
            }
        }
        let quantile = |share: f64| {
            let mut left = (share * f64::from(count)) as u32;
            let level = histogram.iter().position(|&number| {
                let is_here = number > left;
                left = left.saturating_sub(number);
                is_here
            });
            level.unwrap_or(0) as f32
        };
        self.floor = quantile(FLOOR);
        let paint = quantile(UNPAINTED);
        self.paint = if self.paint == 0.0 { paint } else { self.paint + SHARE * (paint - self.paint) };
    }

    /// Distance of a row ahead of the robot's origin (m).
    pub(super) fn ahead(&self, row: usize) -> f64 {
        self.camera.ahead + NEAR + CELL * row as f64
    }

    /// Row at a distance ahead of the robot's origin (m).
    pub(super) fn row(&self, ahead: f64) -> usize {
        ((ahead - self.camera.ahead - NEAR) / CELL).round().clamp(0.0, (ROWS - 1) as f64) as usize
    }

    /// Column where the camera's ray to a cell passes another row.
    pub(super) fn on_ray(&self, row: usize, column: usize, other: usize) -> usize {
        let away = |row: usize| NEAR + CELL * row as f64;
        self::column(self.left + (left(column) - self.left) * away(other) / away(row))
    }

    /// Distance of the camera ahead of the robot's origin (m).
    pub(super) fn from(&self) -> f64 {
        self.camera.ahead
    }

    /// Cells that a pixel covers at a row, rounded up.
    pub(super) fn blur(&self, row: usize) -> usize {
        self.blur[row]
    }

    /// Length of ground along the road that a pixel covers at a row (m).
    pub(super) fn length(&self, row: usize) -> f64 {
        self.depth[row]
    }

    /// Cells that a pixel covers along the road at a row.
    pub(super) fn depth(&self, row: usize) -> f64 {
        self.depth[row] / CELL
    }

    /// Whether a cell is in view.
    pub(super) fn sees(&self, row: usize, column: usize) -> bool {
        self.seen[column].contains(&row)
    }

    /// Whether a brightness and its surroundings differ as much as paint and floor: 0 to 1.
    fn contrast(&self, bright: f32, beside: f32) -> f64 {
        let full = (self.paint.max(self.floor + LEAST) - beside).max(LEAST);
        f64::from(((bright - beside) / full).clamp(0.0, 1.0))
    }

    /// The projection to an image at a pitch.
    pub(super) fn projection(&self, image: GrayView<'_>, pitch: f64) -> Projection {
        self.camera.projection(pitch, (image.width() as u32, image.height() as u32))
    }

    /// Brightness of a pixel between floor and paint, 0 to 1.
    pub(super) fn level(&self, gray: f32) -> f64 {
        self.contrast(gray, self.floor)
    }

    /// Brightness of a cell between floor and paint, 0 to 1.
    pub(super) fn brightness(&self, row: usize, column: usize) -> f64 {
        self.contrast(self.gray[row * COLUMNS + column], self.floor)
    }

    /// Brightness between floor and paint of a place on the ground, the distance of which along the road is
    /// about known; `None` outside the view.
    pub(super) fn brightness_at(&self, road: &RoadAhead, place: Point, ahead: f64) -> Option<f64> {
        // The place is brought into the frame of the road by Newton's method.
        let foot = |ahead: f64| {
            let (centre, aside) = road.at(ahead);
            let arm = place - centre;
            (arm.dot(&Vector::new(aside.y, -aside.x)), arm.dot(&aside))
        };
        let ahead = (0..2).fold(ahead, |ahead, _| ahead + foot(ahead).0);
        let (_, left) = foot(ahead);
        let row = (ahead - self.ahead(0)) / CELL;
        let column = SIDE as f64 + left / CELL;
        let (i, j) = (row.floor(), column.floor());
        if !(i >= 0.0 && j >= 0.0 && i + 1.0 < ROWS as f64 && j + 1.0 < COLUMNS as f64) {
            return None;
        }
        let (u, v) = (column - j, row - i);
        let (i, j) = (i as usize, j as usize);
        let across = |row: usize| (1.0 - u) * self.brightness(row, j) + u * self.brightness(row, j + 1);
        Some((1.0 - v) * across(i) + v * across(i + 1))
    }

    /// Mean brightness of rows of a column, between floor and paint.
    pub(super) fn mean_brightness(&self, rows: Range<usize>, column: usize) -> f64 {
        self.contrast(self.mean(rows, column), self.floor)
    }

    fn mean(&self, rows: Range<usize>, column: usize) -> f32 {
        let sum = self.sums[rows.end * COLUMNS + column] - self.sums[rows.start * COLUMNS + column];
        sum / rows.len().max(1) as f32
    }

    /// Contrast of a line across the road, of a width along the road (m), with the floor before and behind
    /// it, at each column of a row; `None` if that is out of view.
    pub(super) fn across(&self, row: usize, width: f64) -> impl Fn(usize) -> Option<f64> + '_ {
        let blur = self.depth[row];
        let count = ((width.max(blur) / CELL).round() as usize).max(1);
        let (gap, side) = ((0.5 * blur / CELL).ceil() as usize, 3);
        let to = (row + count).saturating_sub(count / 2);
        let last = to + gap + side;
        let first = row.checked_sub(count / 2 + gap + side);
        move |column| {
            let first = first?;
            let seen = &self.seen[column];
            if first < seen.start || last > seen.end {
                return None;
            }
            let line = self.mean(to - count..to, column);
            let beside = self.mean(first..first + side, column).max(self.mean(last - side..last, column));
            Some(self.contrast(line, beside))
        }
    }

    /// Contrast of a line along the road near a column, within two cells; `None` if that is out of view.
    pub(super) fn along(&self, row: usize, column: usize) -> Option<f64> {
        if !(5..COLUMNS - 6).contains(&column) || !self.sees(row, column - 5) || !self.sees(row, column + 5) {
            return None;
        }
        let line = &self.gray[row * COLUMNS..][..COLUMNS];
        let contrast = |at: usize| {
            let middle = line[at];
            self.contrast(middle, line[at - 3].max(line[at + 3]))
        };
        Some((column - 2..=column + 2).map(contrast).fold(0.0, f64::max))
    }
}

/// Brightness between four pixels; `None` outside the image.
#[inline]
fn sample(image: GrayView<'_>, (column, row): (f64, f64)) -> Option<f32> {
    let (x, y) = (column - 0.5, row - 0.5);
    let (width, height) = (image.width() as f64 - 1.0, image.height() as f64 - 1.0);
    if !(x >= 0.0 && y >= 0.0 && x < width && y < height) {
        return None;
    }
    let (i, j) = (x as usize, y as usize);
    let (u, v) = ((x - i as f64) as f32, (y - j as f64) as f32);
    let across = |line: &[u8]| f32::from(line[i]) * (1.0 - u) + f32::from(line[i + 1]) * u;
    Some(across(image.row(j)) * (1.0 - v) + across(image.row(j + 1)) * v)
}
