use crate::world::World;
use crate::world::space::SolidId;

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
}

pub(super) fn movables(world: &World, solids: &[SolidId]) -> Vec<Movable> {
    let movable = |(&solid, object): (&SolidId, &crate::world::Object)| {
        let mass = if object.kind.fixed { f64::INFINITY } else { object.kind.mass };
        let top = object.elevation + object.kind.shape.height();
        Movable { solid, mass, falls: object.kind.falls, top }
    };
    solids.iter().zip(&world.objects).map(movable).collect()
}
