use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use image::{Rgb, RgbImage};
use roverlab::drive::marine::DepthMap;
use roverlab::files::write_whole;
use roverlab::geometry::units::to_mm;
use roverlab::picture::ramp;

use crate::common::{Failure, rounded};

/// Pixels along a cell.
const PIXELS: u32 = 8;
/// What a grid says of a cell without a depth.
const NO_DATA: f64 = -9999.0;

/// Files of a map: the picture and its companions.
pub(super) fn files(picture: &Path) -> [PathBuf; 3] {
    [picture.to_path_buf(), picture.with_extension("asc"), picture.with_extension("csv")]
}

/// Saves a map as a picture, an ESRI grid and a table.
pub(super) fn save(map: &DepthMap, cell: f64, picture: &Path) -> Result<(), Failure> {
    let [png, asc, csv] = files(picture);
    let failed = |file: &Path, error: &dyn std::fmt::Display| {
        Failure::run(format!("--map {}: {error}", file.display()))
    };
    painted(map).save(&png).map_err(|error| failed(&png, &error))?;
    write_whole(&asc, grid(map, cell).as_bytes()).map_err(|error| failed(&asc, &error))?;
    write_whole(&csv, table(map).as_bytes()).map_err(|error| failed(&csv, &error))
}

/// The shallowest and the deepest cell.
pub(super) fn range(map: &DepthMap) -> (f64, f64) {
    let all =
        (0..map.rows()).flat_map(|row| (0..map.columns()).filter_map(move |column| map.cell(column, row)));
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), cell| {
        (low.min(cell.depth), high.max(cell.depth))
    })
}

/// Each cell by its depth: dark is deep. The first row of pixels has the largest y.
fn painted(map: &DepthMap) -> RgbImage {
    let (low, high) = range(map);
    let (columns, rows) = (map.columns() as u32, map.rows() as u32);
    RgbImage::from_fn(columns * PIXELS, rows * PIXELS, |x, y| {
        let (column, row) = (x / PIXELS, rows - 1 - y / PIXELS);
        map.cell(column as usize, row as usize).map_or(Rgb([255; 3]), |cell| {
            let colour = ramp(1.0 - (cell.depth - low) / (high - low).max(1e-3));
            Rgb([colour.red, colour.green, colour.blue])
        })
    })
}

/// The depths in mm, the largest y first.
fn grid(map: &DepthMap, cell: f64) -> String {
    let corner = map.centre(0, 0);
    let [x, y] = [corner.x, corner.y].map(|at| rounded(to_mm(at)));
    let mut text = format!(
        "ncols {}\nnrows {}\nxllcenter {x}\nyllcenter {y}\ncellsize {}\nNODATA_value {NO_DATA}\n",
        map.columns(),
        map.rows(),
        rounded(to_mm(cell))
    );
    for row in (0..map.rows()).rev() {
        let depth =
            |column| map.cell(column, row).map_or(NO_DATA, |cell| (10.0 * to_mm(cell.depth)).round() / 10.0);
        let line: Vec<String> = (0..map.columns()).map(|column| depth(column).to_string()).collect();
        text += &(line.join(" ") + "\n");
    }
    text
}

/// A line for each cell.
fn table(map: &DepthMap) -> String {
    let mut text = "x_mm,y_mm,depth_mm,sigma_mm\n".to_owned();
    for (column, row) in (0..map.rows()).flat_map(|row| (0..map.columns()).map(move |column| (column, row))) {
        let centre = map.centre(column, row);
        if let Some(cell) = map.cell(column, row) {
            let [x, y, depth, sigma] = [centre.x, centre.y, cell.depth, cell.sigma].map(to_mm);
            let _ = writeln!(text, "{x:.0},{y:.0},{depth:.1},{sigma:.1}");
        }
    }
    text
}
