use super::canvas::{Canvas, first_pixel};
use super::light::{SUN, scaled, shade};
use super::view::{NEAR, Place, Seen, View};
use crate::world::Colour;

/// Draws a ball, exact to the pixel, with the depth test.
pub(super) fn draw_ball(canvas: &mut Canvas, view: &View, centre: Place, radius: f64, colour: Colour) {
    let centre = view.see(centre);
    let power = centre.dot(centre) - radius * radius;
    // A ball around the camera is invisible.
    if power <= 0.0 || radius <= 0.0 || view.misses(centre, radius) {
        return;
    }
    let sun = view.turned(SUN);
    let half = (0.5 * view.width as f64, 0.5 * view.height as f64);
    let (top, bottom) = extent(centre.y, centre.z, radius, view.focal, half.1, view.height);
    let (left, right) = extent(centre.x, centre.z, radius, view.focal, half.0, view.width);
    for row in top..bottom {
        let y = view.ray_y(row as f64);
        let start = row * canvas.width;
        for column in left..right {
            let ray = Seen { x: view.ray_x(column as f64), y, z: 1.0 };
            let (along, squared) = (ray.dot(centre), ray.dot(ray));
            let inside = along * along - squared * power;
            if inside < 0.0 || along <= 0.0 {
                continue;
            }
            // The ray advances one metre of depth per unit, so this is the depth.
            let depth = (along - inside.sqrt()) / squared;
            let near = (1.0 / depth) as f32;
            if depth < NEAR || near <= canvas.nearness[start + column] {
                continue;
            }
            let hit = Seen { x: ray.x * depth, y: ray.y * depth, z: depth };
            let cosine = hit.minus(centre).dot(sun) / radius;
            canvas.nearness[start + column] = near;
            canvas.colours[start + column] = scaled(colour, shade(cosine));
        }
    }
}

/// First pixel, and the one after the last, that a ball may cover along one side of the picture.
fn extent(aside: f64, ahead: f64, radius: f64, focal: f64, middle: f64, count: usize) -> (usize, usize) {
    let power = aside * aside + ahead * ahead - radius * radius;
    let square = ahead * ahead - radius * radius;
    // Beside the camera, a ball's outline is unbounded.
    if power <= 0.0 || ahead <= 0.0 || square <= 0.0 {
        return (0, count);
    }
    let reach = radius * power.sqrt();
    let edge = |sign: f64| middle + focal * (aside * ahead + sign * reach) / square;
    (first_pixel(edge(-1.0), count), first_pixel(edge(1.0), count))
}
