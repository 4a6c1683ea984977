use crate::world::World;
use crate::world::space::SolidId;

/// An object and what it takes to push it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Movable {
    pub(super) solid: SolidId,
    /// Kilograms; infinite for what is fixed.
    pub(super) mass: f64,
}

pub(super) fn movables(world: &World, solids: &[SolidId]) -> Vec<Movable> {
    let movable = |(&solid, object): (&SolidId, &crate::world::Object)| {
        let mass = if object.kind.fixed { f64::INFINITY } else { object.kind.mass };
        Movable { solid, mass }
    };
    solids.iter().zip(&world.objects).map(movable).collect()
}
