use super::canvas::{Canvas, Packed, Slope, first_pixel};
use super::face::Cutter;
use super::light::{SUN, scaled, shade};
use super::texture::Texture;
use super::view::{NEAR, Place, Seen, View};
use crate::geometry::{Pose, Pose3, Vector3, direction};
use crate::world::{Colour, Face, Mesh};

/// Surface of things of one kind.
#[derive(Debug)]
pub(super) struct Model {
    faces: Vec<Face>,
    coats: Vec<Coat>,
    /// Radius of the enclosing ball about the foot.
    reach: f64,
}

#[derive(Debug)]
enum Coat {
    Plain(Colour),
    Image(Texture),
}

/// Where a thing stands: its foot, and the unit vectors ahead, to the left and up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stand {
    foot: Place,
    axes: [Place; 3],
}

impl Model {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let coats = mesh.materials.iter().map(|material| {
            let image = material.image.as_deref().and_then(|image| Texture::new(image, material.colour));
            image.map_or(Coat::Plain(material.colour), Coat::Image)
        });
        Self { faces: mesh.faces.clone(), coats: coats.collect(), reach: mesh.reach() }
    }

    /// Draws it at its pose, where it is nearest.
    pub(super) fn draw(&self, cutter: &mut Cutter, canvas: &mut Canvas, view: &View, stand: &Stand) {
        if view.misses(view.see(stand.foot), self.reach) {
            return;
        }
        for face in &self.faces {
            let Some(coat) = self.coats.get(face.material) else { continue };
            let corners = face.corners.map(|corner| stand.place(corner));
            let light = brightness(corners, view.eye);
            match coat {
                Coat::Plain(colour) => {
                    cutter.draw_either_side(canvas, view, &corners, scaled(*colour, light));
                }
                Coat::Image(texture) => {
                    draw_image(cutter, canvas, view, &corners, &face.image_corners, texture, light);
                }
            }
        }
    }
}

impl Stand {
    /// Upright at a pose, at a height above the floor (m).
    pub(super) fn upright(pose: &Pose, z: f64) -> Self {
        let forward = direction(pose.heading);
        let axes = [[forward.x, forward.y, 0.0], [-forward.y, forward.x, 0.0], [0.0, 0.0, 1.0]];
        Self { foot: [pose.x, pose.y, z], axes }
    }

    /// As hills have turned it.
    pub(super) fn slanted(pose: &Pose3) -> Self {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| pose.rotate(axis).into());
        Self { foot: pose.position.into(), axes }
    }

    /// A place of its own frame.
    pub(super) fn place(&self, [ahead, left, up]: Place) -> Place {
        let Self { foot, axes: [x, y, z] } = self;
        [0, 1, 2].map(|axis| foot[axis] + x[axis] * ahead + y[axis] * left + z[axis] * up)
    }
}

/// Brightness of the side of a triangle that faces the eye.
fn brightness([a, b, c]: [Place; 3], eye: Place) -> f64 {
    let minus = |p: Place, q: Place| Seen { x: p[0] - q[0], y: p[1] - q[1], z: p[2] - q[2] };
    let normal = minus(b, a).cross(minus(c, a));
    let towards = if normal.dot(minus(eye, a)) < 0.0 { -1.0 } else { 1.0 };
    let sun = Seen { x: SUN[0], y: SUN[1], z: SUN[2] };
    shade(towards * normal.dot(sun) / normal.norm().max(f64::MIN_POSITIVE))
}

/// Draws a textured triangle with the depth test.
fn draw_image(
    cutter: &mut Cutter,
    canvas: &mut Canvas,
    view: &View,
    corners: &[Place; 3],
    image_corners: &[[f64; 2]; 3],
    texture: &Texture,
    light: f64,
) {
    let Some(plane) = cutter.look(view, corners) else { return };
    let Some((top, spans)) = cutter.cut(view) else { return };
    let near = plane.nearness(view);
    let (whole, _) = texture.level(0.0);
    let size = [whole.width as f64, whole.height as f64];
    let seen = corners.map(|corner| view.see(corner));
    // Texture coordinates times inverse depth are linear in the picture.
    let texels =
        [0, 1].map(|axis| over_picture(view, &seen, image_corners.map(|c| c[axis] * size[axis]), &near));
    let light = (256.0 * light) as u32;
    for (row, span) in (top..).zip(spans) {
        let (from, to) = (first_pixel(span.left, canvas.width), first_pixel(span.right, canvas.width));
        if from >= to {
            continue;
        }
        let place = |column: usize, row: usize| {
            let depth = 1.0 / near.at(column, row);
            texels.each_ref().map(|slope| slope.at(column, row) * depth)
        };
        let (level, halvings) = texture.level(step(place, usize::midpoint(from, to), row));
        let scale = 1.0 / f64::from(1_u32 << halvings);
        for column in from..to {
            let at = row * canvas.width + column;
            let here = near.at(column, row);
            if here as f32 <= canvas.nearness[at] || here > 1.0 / NEAR {
                continue;
            }
            let [u, v] = place(column, row).map(|texel| (texel * scale) as f32);
            if let Some(colour) = level.smooth(u, v) {
                canvas.nearness[at] = here as f32;
                canvas.colours[at] = dimmed(colour, light);
            }
        }
    }
}

/// Inverse depth times a linear function on a triangle, as a function on the picture.
fn over_picture(view: &View, [a, b, c]: &[Seen; 3], values: [f64; 3], near: &Slope) -> Slope {
    let (along, across) = (b.minus(*a), c.minus(*a));
    let normal = along.cross(across);
    let squared = normal.dot(normal);
    let (first, second) = (across.cross(normal), normal.cross(along));
    let (one, other) = ((values[1] - values[0]) / squared, (values[2] - values[0]) / squared);
    // Gradient per metre to the right, down and ahead.
    let gradient = Seen {
        x: one * first.x + other * second.x,
        y: one * first.y + other * second.y,
        z: one * first.z + other * second.z,
    };
    let offset = values[0] - gradient.dot(*a);
    Slope {
        origin: gradient.x * view.ray_x(0.0)
            + gradient.y * view.ray_y(0.0)
            + gradient.z
            + offset * near.origin,
        column: gradient.x / view.focal + offset * near.column,
        row: gradient.y / view.focal + offset * near.row,
    }
}

/// Texels from a pixel to the next along the row or column, whichever is larger.
fn step(place: impl Fn(usize, usize) -> [f64; 2], column: usize, row: usize) -> f64 {
    let here = place(column, row);
    let beside = |there: [f64; 2]| (there[0] - here[0]).abs().max((there[1] - here[1]).abs());
    beside(place(column + 1, row)).max(beside(place(column, row + 1)))
}

/// A colour in 256ths of the light.
pub(super) fn dimmed(colour: Packed, light: u32) -> Packed {
    let part = |mask: Packed| (((colour & mask) * light) >> 8) & mask;
    part(0xff_00_ff) | part(0xff00)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_dimmed_channel_by_channel() {
        assert_eq!(dimmed(0xff_80_40, 128), 0x7f_40_20);
        assert_eq!(dimmed(0xff_ff_ff, 256), 0xff_ff_ff);
        assert_eq!(dimmed(0xff_ff_ff, 0), 0);
    }
}
