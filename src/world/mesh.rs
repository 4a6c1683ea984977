use std::sync::Arc;

use image::RgbaImage;

use super::Colour;
use crate::geometry::math;

/// The surface of a thing for cameras: triangles, visible from both sides.
///
/// Points are metres ahead, to the left and up from the thing's foot. Robots and other sensors do not notice
/// the mesh; for them, the thing has its shape.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Materials of the faces.
    pub materials: Vec<Material>,
    /// The triangles.
    pub faces: Vec<Face>,
}

/// Material of a face.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Its colour, which multiplies that of the image.
    pub colour: Colour,
    /// An image; pixels with less than half opacity are invisible.
    pub image: Option<Arc<RgbaImage>>,
}

/// A triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// Positions of its corners.
    pub corners: [[f64; 3]; 3],
    /// Their positions in the material's image: columns from its left edge and rows from its upper edge, as
    /// fractions of the image's size. Outside 0 to 1 the image repeats.
    pub image_corners: [[f64; 2]; 3],
    /// Index of its material.
    pub material: usize,
}

impl Mesh {
    /// Radius of the enclosing ball about the foot (m).
    pub fn reach(&self) -> f64 {
        let corners = self.faces.iter().flat_map(|face| face.corners);
        corners.map(|c| c.iter().map(|x| x * x).sum::<f64>()).fold(0.0, f64::max).sqrt()
    }

    /// Adds a material; returns its index.
    pub(super) fn paint(&mut self, colour: Colour, image: Option<RgbaImage>) -> usize {
        self.materials.push(Material { colour, image: image.map(Arc::new) });
        self.materials.len() - 1
    }

    /// Adds a flat quadrangle with the whole image of its material. The corners are upper left, lower left,
    /// lower right and upper right.
    pub(super) fn quadrangle(&mut self, corners: [[f64; 3]; 4], material: usize) {
        let on_image = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
        for order in [[0, 1, 2], [0, 2, 3]] {
            let face = Face {
                corners: order.map(|i| corners[i]),
                image_corners: order.map(|i| on_image[i]),
                material,
            };
            self.faces.push(face);
        }
    }

    /// Adds a surface of revolution about the upright axis through the foot: rings with a radius and height,
    /// each joined to the next.
    pub(super) fn turned(&mut self, rings: &[[f64; 2]], material: usize) {
        /// Number of sides of a cylinder's prism.
        const SIDES: usize = 20;
        let at = |[radius, height]: [f64; 2], side: usize| {
            let (sin, cos) = math::sin_cos(std::f64::consts::TAU * (side % SIDES) as f64 / SIDES as f64);
            [radius * cos, radius * sin, height]
        };
        for pair in rings.windows(2) {
            for side in 0..SIDES {
                let corners =
                    [at(pair[1], side), at(pair[0], side), at(pair[0], side + 1), at(pair[1], side + 1)];
                self.quadrangle(corners, material);
            }
        }
    }

    /// Adds a cuboid between two opposite corners.
    pub(super) fn cuboid(&mut self, low: [f64; 3], high: [f64; 3], material: usize) {
        let corner =
            |x: usize, y: usize, z: usize| [[low[0], high[0]][x], [low[1], high[1]][y], [low[2], high[2]][z]];
        // Around it, each side's upper left corner first, then top and bottom.
        let round = [(0, 1), (0, 0), (1, 0), (1, 1)];
        for (i, &(x, y)) in round.iter().enumerate() {
            let (u, v) = round[(i + 1) % 4];
            self.quadrangle([corner(x, y, 1), corner(x, y, 0), corner(u, v, 0), corner(u, v, 1)], material);
        }
        for z in [0, 1] {
            self.quadrangle(round.map(|(x, y)| corner(x, y, z)), material);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_surfaces_reach_as_far_as_their_sizes_say() {
        let mut mesh = Mesh::default();
        let material = mesh.paint(Colour::RED, None);
        mesh.turned(&[[0.3, 0.0], [0.0, 0.4]], material);
        assert!((mesh.reach() - 0.4).abs() < 1e-12);
        mesh.cuboid([-0.1, -0.2, 0.0], [0.3, 0.2, 1.2], material);
        assert!((mesh.reach() - math::hypot(1.2, math::hypot(0.3, 0.2))).abs() < 1e-12);
        assert_eq!(mesh.faces.len(), 2 * 20 + 12);
        assert_eq!(Mesh::default().reach(), 0.0);
    }
}
