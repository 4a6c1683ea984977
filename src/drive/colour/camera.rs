use crate::vision::CameraGeometry;
use crate::world::CameraSpec;

impl From<&CameraSpec> for CameraGeometry {
    fn from(spec: &CameraSpec) -> Self {
        Self { field_of_view: spec.field_of_view, height: spec.mount.z, ahead: spec.mount.x }
    }
}
