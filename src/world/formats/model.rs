//! 3D models: Wavefront OBJ files, with their materials (MTL) and images.
//!
//! OBJ's axes are right-handed: x to the left, y up and z forward, as seen by who sits in the model. Faces
//! keep the diffuse colour and image of their material (`Kd`, `map_Kd`) and are left out if it is more
//! transparent than not (`d`, `Tr`).

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use image::RgbaImage;

use super::error::{FormatError, Location, Notes};
use super::image_file::decode_image;
use super::lexer::shown;
use super::limits::{MAX_FACES, MAX_IMAGE_BYTES, MAX_METRES, MAX_TEXT_BYTES};
use super::source::{Files, SourceFile, decode};
use crate::world::{Colour, Face, Material, Mesh};

/// Consequence for an object without a usable model.
const SHAPE_INSTEAD: &str = "cameras see the shape of its colliders";
/// Consequence for a face without a usable image.
const GRAY_INSTEAD: &str = "it is gray";

/// Reads the model that a file names at some place, `scale` metres in a unit; faces without a material have a
/// colour. `None` if that fails and is got over.
pub(super) fn load(
    model: &Path,
    named: (&str, Location),
    (scale, colour): (f64, Colour),
    files: &mut Files<'_>,
    notes: &mut Notes<'_>,
) -> Result<Option<Arc<Mesh>>, FormatError> {
    let read = files.read(&model.to_string_lossy(), named, MAX_TEXT_BYTES);
    let read = read.and_then(|source| parse(source, (scale, colour), files, notes));
    Ok(files.get_over(read, SHAPE_INSTEAD, notes)?.map(Arc::new))
}

fn parse(
    source: SourceFile,
    (scale, colour): (f64, Colour),
    files: &mut Files<'_>,
    notes: &mut Notes<'_>,
) -> Result<Mesh, FormatError> {
    let name = source.name;
    let mut own = Notes::new(&name);
    let text = decode(source.bytes, &mut own)?;
    notes.extend(own.finish(()).warnings);
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    // Materials are read where the model names them; their errors are reported afterwards.
    let library = RefCell::new(Library { model: &name, files, failure: None, origins: BTreeMap::new() });
    let read =
        tobj::load_obj_buf(&mut text.as_bytes(), &options, |file| library.borrow_mut().read(&text, file));
    let Library { failure, origins, .. } = library.into_inner();
    if let Some(error) = failure {
        files.get_over::<()>(Err(error), GRAY_INSTEAD, notes)?;
    }
    let broken = |found: String| FormatError::new(&name, Location::START, found, "a Wavefront OBJ model");
    let (models, materials) = read.map_err(|error| broken(format!("a broken model ({error})")))?;
    let mut mesh = Mesh::default();
    // The last one is for faces without a material.
    for material in materials.unwrap_or_default() {
        let origin = origins.get(&material.name).map_or(name.as_str(), String::as_str);
        mesh.materials.push(painted(&material, origin, files, notes)?);
    }
    mesh.materials.push(Material { colour, image: None });
    for part in &models {
        add(&mut mesh, &part.mesh, scale).map_err(broken)?;
    }
    Ok(mesh)
}

/// The files of materials that a model names.
struct Library<'a, 'f> {
    model: &'a str,
    files: &'a mut Files<'f>,
    /// The first thing that went wrong.
    failure: Option<FormatError>,
    /// The file of each material.
    origins: BTreeMap<String, String>,
}

impl Library<'_, '_> {
    fn read(&mut self, model: &str, file: &Path) -> tobj::MTLLoadResult {
        let reference = file.to_string_lossy();
        let named = (self.model, place_of(model, &reference));
        let source = self.files.read(&reference, named, MAX_TEXT_BYTES);
        let read = source.and_then(|SourceFile { name, bytes }| {
            let text = decode(bytes, &mut Notes::new(&name))?;
            check_colours(&text, &name)?;
            let materials = tobj::load_mtl_buf(&mut text.as_bytes());
            let materials = materials.map_err(|error| {
                let found = format!("broken materials ({error})");
                FormatError::new(&name, Location::START, found, "a Wavefront MTL file")
            })?;
            self.origins.extend(materials.0.iter().map(|material| (material.name.clone(), name.clone())));
            Ok(materials)
        });
        read.map_err(|error| {
            self.failure.get_or_insert(error);
            tobj::LoadError::OpenFileFailed
        })
    }
}

/// Refuses colours of fewer than three numbers, on which the reader of materials panics.
fn check_colours(materials: &str, file: &str) -> Result<(), FormatError> {
    let is_short = |line: &str| {
        let mut words = line.split_whitespace();
        words.next().is_some_and(|word| ["Ka", "Kd", "Ks", "Ke"].contains(&word)) && words.count() < 3
    };
    materials.lines().position(is_short).map_or(Ok(()), |index| {
        let found = shown(materials.lines().nth(index).unwrap_or_default().trim());
        Err(FormatError::new(
            file,
            Location { line: index + 1, column: 1 },
            found,
            "a colour of three numbers",
        ))
    })
}

/// Where a model names a file.
fn place_of(model: &str, file: &str) -> Location {
    let lines = model.lines().enumerate();
    let found =
        lines.filter(|(_, line)| line.trim_start().starts_with("mtllib")).find_map(|(index, line)| {
            let column = line.find(file)?;
            Some(Location { line: index + 1, column: line[..column].chars().count() + 1 })
        });
    found.unwrap_or(Location::START)
}

fn painted(
    material: &tobj::Material,
    file: &str,
    files: &mut Files<'_>,
    notes: &mut Notes<'_>,
) -> Result<Material, FormatError> {
    let [red, green, blue] = material.diffuse.unwrap_or([0.8; 3]).map(|part| (255.0 * part + 0.5) as u8);
    let image = match &material.diffuse_texture {
        Some(reference) => {
            let source = files.read(reference, (file, Location::START), MAX_IMAGE_BYTES);
            let image = source.and_then(|source| decode_image(&source));
            files.get_over(image, GRAY_INSTEAD, notes)?.map(|image| Arc::new(image.into_rgba8()))
        }
        None => None,
    };
    let hidden = material.dissolve.is_some_and(|opacity| opacity < 0.5);
    // One transparent pixel is nothing to be seen.
    let image = if hidden { Some(Arc::new(RgbaImage::new(1, 1))) } else { image };
    Ok(Material { colour: Colour::new(red, green, blue), image })
}

/// Adds the triangles of a part. The error says what is wrong with them.
fn add(mesh: &mut Mesh, part: &tobj::Mesh, scale: f64) -> Result<(), String> {
    let bare = mesh.materials.len() - 1;
    let material = part.material_id.filter(|&id| id < bare).unwrap_or(bare);
    let (places, on_image) = (part.positions.as_chunks::<3>().0, part.texcoords.as_chunks::<2>().0);
    let corner = |index: u32| {
        let [x, y, z] = *places.get(index as usize)?;
        Some([z, x, y].map(|length| scale * f64::from(length)))
    };
    let image_corner = |number: usize| {
        let [u, v] = *on_image.get(*part.texcoord_indices.get(number)? as usize)?;
        Some([f64::from(u), 1.0 - f64::from(v)])
    };
    if mesh.faces.len() + part.indices.len() / 3 > MAX_FACES {
        return Err(format!("a model of more than {MAX_FACES} triangles"));
    }
    for (number, triangle) in part.indices.as_chunks::<3>().0.iter().enumerate() {
        let [Some(a), Some(b), Some(c)] = triangle.map(corner) else {
            return Err("a face of a corner that is not there".into());
        };
        let corners = [a, b, c];
        if corners.iter().flatten().any(|length| length.is_nan() || length.abs() > MAX_METRES) {
            return Err(format!("a corner at {corners:?} m"));
        }
        let image_corners = [0, 1, 2].map(|i| image_corner(3 * number + i).unwrap_or_default());
        let image_corners =
            image_corners.map(|place| place.map(|part| if part.is_finite() { part } else { 0.0 }));
        mesh.faces.push(Face { corners, image_corners, material });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::world::formats::{MemoryFiles, Parsed};

    const OBJ: &str = "mtllib sign.mtl\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                       usemtl plate\nf 1/1 2/2 3/3 4/4\n";
    const MTL: &str = "newmtl plate\nKd 1 0.5 0\nmap_Kd plate.ppm\n";

    fn read(files: &[(&str, &str)], tolerant: bool) -> Result<Parsed<Option<Arc<Mesh>>>, FormatError> {
        let files = files.iter().map(|(name, text)| (String::from(*name), text.as_bytes().to_vec()));
        let mut source = MemoryFiles(files.collect());
        let mut notes = Notes::new("sign.esObj");
        let at = Location { line: 3, column: 5 };
        let mesh = load(
            Path::new("sign.obj"),
            ("sign.esObj", at),
            (0.5, Colour::BLUE),
            &mut Files::new(&mut source, tolerant),
            &mut notes,
        )?;
        Ok(notes.finish(mesh))
    }

    #[test]
    fn a_square_becomes_two_triangles_in_our_axes() {
        let files = [("sign.obj", OBJ), ("sign.mtl", MTL), ("plate.ppm", "P3 1 1 255 9 8 7\n")];
        let Parsed { value, warnings } = read(&files, false).unwrap();
        assert_eq!(warnings, []);
        let mesh = value.unwrap();
        assert_eq!(mesh.faces.len(), 2);
        assert_eq!(mesh.faces[0].corners, [[0.0; 3], [0.0, 0.5, 0.0], [0.0, 0.5, 1.0]]);
        assert_eq!(mesh.faces[0].image_corners, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
        let material = &mesh.materials[mesh.faces[0].material];
        assert_eq!(material.colour, Colour::new(255, 128, 0));
        assert_eq!(material.image.as_ref().unwrap().get_pixel(0, 0).0, [9, 8, 7, 255]);
    }

    #[test]
    fn what_is_missing_is_named_where_it_is_named() {
        let message = |files: &[(&str, &str)]| read(files, false).unwrap_err().to_string();
        assert_eq!(
            message(&[]),
            "sign.esObj:3:5: found `sign.obj`, which does not exist; expected a file that exists"
        );
        assert_eq!(
            message(&[("sign.obj", OBJ)]),
            "sign.obj:1:8: found `sign.mtl`, which does not exist; expected a file that exists"
        );
        assert_eq!(
            message(&[("sign.obj", OBJ), ("sign.mtl", MTL)]),
            "sign.mtl:1:1: found `plate.ppm`, which does not exist; expected a file that exists"
        );
        let short = [("sign.obj", OBJ), ("sign.mtl", "newmtl plate\n Kd 1 2\n")];
        assert_eq!(message(&short), "sign.mtl:2:1: found `Kd 1 2`; expected a colour of three numbers");
        let broken = message(&[("sign.obj", "v 0 0 0\nf 1 2 3\n")]);
        assert!(broken.starts_with("sign.obj:1:1: found a broken model"), "{broken}");
    }

    #[test]
    fn a_tolerant_reader_goes_on_with_what_there_is() {
        let bare = read(&[], true).unwrap();
        assert_eq!((bare.value, bare.warnings.len()), (None, 1));
        for files in [&[("sign.obj", OBJ)][..], &[("sign.obj", OBJ), ("sign.mtl", MTL)]] {
            let Parsed { value, warnings } = read(files, true).unwrap();
            assert_eq!((value.unwrap().faces.len(), warnings.len()), (2, 1));
            assert!(warnings[0].to_string().ends_with("it is gray"), "{}", warnings[0]);
        }
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn no_model_panics(
            text in "((v|vt|vn|f|usemtl|mtllib|o|g|s|l|p)( (-?[0-9]{1,2}|1e39|nan|/|[1-4]/[1-4]|-1//2|1/2/3|a)){0,6}\n){0,12}",
            materials in "((newmtl|Kd|d|Tr|map_Kd|Ns)( (a|plate.ppm|-?[0-9]|nan)){0,4}\n){0,6}",
        ) {
            for obj in [text.clone(), format!("{OBJ}{text}"), format!("mtllib a\n{text}")] {
                let _ = read(&[("sign.obj", &obj), ("a", &materials), ("sign.mtl", &materials)], true);
            }
        }
    }
}
