use std::f64::consts::{PI, TAU};

use super::{ExtremumKind, local_extrema};
use crate::geometry::{normalize_angle, units};
use crate::io::{Display, DisplayOption, Fill, Font, LidarScan, Result};
use crate::world::Colour;

/// Height of the plot (pixels), as in the book; text and soft keys are below.
const BASE: i32 = 250;
/// Width of a full-turn scan (pixels).
const WIDTH: i32 = 360;
/// Number of beams averaged for the peaks and dips.
const WINDOW: usize = 5;
/// Minimum prominence of a peak or dip (m).
const PROMINENCE: f64 = 0.08;

/// Plots a scan on the display as the book does (programs 4.1 and 4.2): a blue line per beam, from the back
/// over the left, the front at column 180 and the right to the back again; a red line straight ahead and
/// green ones to the sides. Circles mark peaks (magenta) and dips (orange): corners of the room and objects.
///
/// The full height stands for `range` (m), or by default for the longest range of the scan. A beam without an
/// echo is a gray line of full height.
///
/// ```
/// use roverlab::io::{Lcd, LidarScan};
/// use roverlab::scan::plot_scan;
/// let step = 1_f64.to_radians();
/// let ranges = (0..360).map(|beam| if beam < 180 { 0.5 } else { 2.0 }).collect();
/// let (angle_min, angle_increment, range_max) = (-180.0 * step, step, 4.0);
/// let scan = LidarScan { angle_min, angle_increment, range_max, ranges, ..LidarScan::default() };
/// let mut display = Lcd::new();
/// plot_scan(&mut display, &scan, None)?;
/// let is_blue = |column, row| display.frame().get_pixel(column, row).0 == [0, 0, 255];
/// let blue = |column| (0..250).filter(|&row| is_blue(column, row)).count();
/// assert!(blue(40) > 2 * blue(320), "near objects, on the right, have short lines");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
///
/// # Errors
///
/// If the display reports one.
pub fn plot_scan(display: &mut (impl Display + ?Sized), scan: &LidarScan, range: Option<f64>) -> Result<()> {
    let longest = scan.ranges.iter().copied().filter(|range| range.is_finite()).fold(0.0, f64::max);
    let full = range.unwrap_or(longest).max(1e-3);
    let height = |range: f64| (f64::from(BASE) * (range / full).min(1.0)).round() as i32;
    display.set_display_option(DisplayOption::AutoRefresh, false)?;
    display.clear_display()?;
    for column in 0..WIDTH {
        let bearing = PI - TAU * f64::from(column) / f64::from(WIDTH);
        let Some(beam) = scan.beam_at(normalize_angle(bearing - scan.mount.heading)) else { continue };
        let range = scan.ranges[beam];
        let (length, colour) = if range.is_finite() {
            (height(range), Colour::BLUE)
        } else {
            (BASE, Colour::from_hex(0xb0_b0_b0))
        };
        display.draw_line((column, BASE - length), (column, BASE), colour)?;
    }
    for (column, colour) in [(180, Colour::RED), (90, Colour::GREEN), (270, Colour::GREEN)] {
        display.draw_line((column, 0), (column, BASE), colour)?;
    }
    for extremum in local_extrema(scan, WINDOW, PROMINENCE) {
        let at = (column_of(extremum.angle + scan.mount.heading), BASE - height(extremum.range));
        let colour = match extremum.kind {
            ExtremumKind::Peak => Colour::from_hex(0xff_00_ff),
            ExtremumKind::Dip => Colour::from_hex(0xff_a5_00),
        };
        display.draw_circle(at, 9, colour, Fill::Solid)?;
    }
    print_scale(display, full)?;
    display.refresh()?;
    display.set_display_option(DisplayOption::AutoRefresh, true)
}

/// Labels of the directions below their columns, and of the full height.
fn print_scale(display: &mut (impl Display + ?Sized), full: f64) -> Result<()> {
    /// Display row below the plot.
    const LINE: i32 = 19;
    /// Number of characters of the default font per display width.
    const LETTERS: i32 = 80;
    display.set_font(Font::default())?;
    let width = (display.display_size()?.0 / LETTERS).max(1);
    for (label, bearing) in [("180", PI), ("90", 0.5 * PI), ("0", 0.0), ("-90", -0.5 * PI)] {
        let text = label.len() as i32;
        let column = (column_of(bearing) / width - text / 2).max(0);
        display.set_cursor(LINE, column)?;
        display.print(label)?;
    }
    display.set_cursor(LINE, WIDTH / width + 1)?;
    display.print(&format!("full {:.0} mm", units::to_mm(full)))
}

/// Column of a bearing (rad, counter-clockwise from straight ahead).
fn column_of(bearing: f64) -> i32 {
    let turns = (PI - normalize_angle(bearing)) / TAU;
    ((turns * f64::from(WIDTH)).round() as i32).rem_euclid(WIDTH)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::io::Lidar;
    use crate::io::sim::{Lcd, SimOptions, Simulation};
    use crate::world::{RobotSpec, Scene, World};

    #[test]
    fn lines_are_as_long_as_ranges() {
        // A wall 1 m ahead, 2 m to the left, 0.5 m to the right, 1.5 m behind.
        let scene = Scene::with_robot(World::walled(2.5, 2.5), RobotSpec::s4(), Pose::new(1.5, 0.5, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::ideal()).unwrap();
        let scan = simulation.robot(0).unwrap().scan().unwrap();
        let mut lcd = Lcd::new();
        plot_scan(&mut lcd, &scan, Some(2.5)).unwrap();
        let blue = |column: i32, height: i32| {
            lcd.frame().get_pixel(column as u32, (BASE - height) as u32).0 == [0, 0, 255]
        };
        // 100 pixels per metre; next to the coloured lines.
        assert!(blue(181, 90) && !blue(181, 105), "ahead");
        assert!(blue(92, 190) && !blue(92, 205), "left");
        assert!(blue(268, 45) && !blue(268, 60), "right");
        assert!(blue(1, 140) && !blue(1, 155), "behind");
        assert_eq!(lcd.frame().get_pixel(180, 5).0, [255, 0, 0]);
    }

    #[test]
    fn directions_have_columns() {
        assert_eq!([0.0, 0.5 * PI, -0.5 * PI].map(column_of), [180, 90, 270]);
        assert!([PI, -PI].iter().all(|&back| column_of(back) % 360 == 0));
    }

    #[test]
    fn an_empty_scan_is_an_empty_plot() {
        let mut lcd = Lcd::new();
        plot_scan(&mut lcd, &LidarScan::default(), None).unwrap();
        assert_eq!(lcd.frame().get_pixel(181, 200).0, lcd.frame().get_pixel(470, 200).0);
    }
}
