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
}

pub(super) fn movables(world: &World, solids: &[SolidId]) -> Vec<Movable> {
    let movable = |(&solid, object): (&SolidId, &crate::world::Object)| {
        let mass = if object.kind.fixed { f64::INFINITY } else { object.kind.mass };
        let top = object.elevation + object.kind.shape.height();
        let rolls = matches!(object.kind.shape, Shape::Sphere { .. });
        Movable { solid, mass, falls: object.kind.falls, top, rolls, velocity: Vector::zeros() }
    };
    solids.iter().zip(&world.objects).map(movable).collect()
}
