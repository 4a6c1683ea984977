//! Renders SVG to pixels.

use resvg::{tiny_skia, usvg};

/// Pixels per unit of the document.
const FINENESS: f32 = 2.0;

/// The bytes of a PNG file of an SVG document, or the reason for failure.
pub(super) fn png(document: &str) -> Result<Vec<u8>, String> {
    let mut options = usvg::Options { font_family: "DejaVu Sans".into(), ..usvg::Options::default() };
    let fonts = options.fontdb_mut();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    let tree = usvg::Tree::from_str(document, &options).map_err(|e| e.to_string())?;
    let (width, height) = (tree.size().width() * FINENESS, tree.size().height() * FINENESS);
    let mut pixels = tiny_skia::Pixmap::new(width.ceil() as u32, height.ceil() as u32)
        .ok_or_else(|| format!("{width} by {height} pixels"))?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(FINENESS, FINENESS), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| e.to_string())
}
