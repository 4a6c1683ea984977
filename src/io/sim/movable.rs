use crate::geometry::Vector;
use crate::world::space::SolidId;
use crate::world::{Shape, World};

/// An object, with the data for pushing it or knocking it over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Movable {
    pub(super) solid: SolidId,
    /// Mass (kg); infinite for fixed objects.
    pub(super) mass: f64,
    /// Whether it falls instead of being pushed.
    pub(super) falls: bool,
    /// Height of its top above the floor while upright (m).
    pub(super) top: f64,
    /// Whether it rolls down hills, where others slide, and how fast it does, over the plane.
    pub(super) rolls: bool,
    pub(super) velocity: Vector,
    /// Height from foot to top (m).
    height: f64,
    /// Mass (kg), whether it is fixed, and volume of displaced water (m³).
    weight: f64,
    volume: f64,
}

pub(super) fn movables(world: &World, solids: &[SolidId]) -> Vec<Movable> {
    let movable = |(&solid, object): (&SolidId, &crate::world::Object)| {
        let mass = if object.kind.fixed { f64::INFINITY } else { object.kind.mass };
        let top = object.elevation + object.kind.shape.height();
        Movable {
            solid,
            mass,
            falls: object.kind.falls,
            top,
            rolls: matches!(object.kind.shape, Shape::Sphere { .. }),
            velocity: Vector::zeros(),
            height: object.kind.shape.height(),
            weight: object.kind.mass,
            volume: if object.kind.fixed { 0.0 } else { object.kind.buoyancy.unwrap_or(0.0) },
        }
    };
    solids.iter().zip(&world.objects).map(movable).collect()
}

impl Movable {
    /// How deep its foot is under the surface when it floats in water of a density; `None` if it sinks. Its
    /// cross-section is taken for the same all the way up.
    pub(super) fn draught(&self, density: f64) -> Option<f64> {
        let carried = density * self.volume;
        (carried > self.weight).then(|| self.height * self.weight / carried)
    }
}
