//! An SVG of ours as PNG, on white.

use super::parsed::parsed;
use crate::error::ReportError;
use resvg::tiny_skia;

const CSS_PIXELS_PER_INCH: f32 = 96.0;
const INCHES_PER_METRE: f64 = 1.0 / 0.0254;
const COARSE_BELOW: f64 = 150.0;
/// On a side: A0 at 300 dots per inch.
const MOST_PIXELS: f32 = 14_100.0;

/// Renders an SVG; `description` goes into the file.
pub(crate) fn render(
    figure: &str,
    svg: &str,
    description: &str,
    dots_per_inch: f64,
) -> Result<Vec<u8>, ReportError> {
    let failed = |reason: String| ReportError::Png { figure: figure.to_owned(), reason };
    let tree = parsed(svg).map_err(|error| failed(error.to_string()))?;
    let scale = dots_per_inch as f32 / CSS_PIXELS_PER_INCH;
    let size = tree.size();
    let longest = size.width().max(size.height()) * scale;
    if !(1.0..=MOST_PIXELS).contains(&longest) {
        return Err(failed(format!(
            "{dots_per_inch} dots per inch make a side of {longest} pixels, expected 1 to {MOST_PIXELS}"
        )));
    }
    let (width, height) =
        ((size.width() * scale).round() as u32, (size.height() * scale).round() as u32);
    let mut pixels = tiny_skia::Pixmap::new(width, height)
        .ok_or_else(|| failed(format!("{width} × {height} is no size for a picture")))?;
    // The last row and column are fractions of a pixel: they would turn grey without this.
    pixels.fill(tiny_skia::Color::WHITE);
    let whole = tiny_skia::Transform::from_scale(
        width as f32 / size.width(),
        height as f32 / size.height(),
    );
    resvg::render(&tree, whole, &mut pixels.as_mut());
    let mut rgb = Vec::with_capacity(pixels.data().len() / 4 * 3);
    for pixel in pixels.data().chunks_exact(4) {
        rgb.extend_from_slice(&pixel[..3]);
    }

    let dots_per_metre = (dots_per_inch * INCHES_PER_METRE).round() as u32;
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // A coarse picture is made to be kept or sent, and quickly packed; a fine one costs ten times as much.
    encoder.set_compression(if dots_per_inch < COARSE_BELOW {
        png::Compression::High
    } else {
        png::Compression::Fast
    });
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: dots_per_metre,
        yppu: dots_per_metre,
        unit: png::Unit::Meter,
    }));
    encoder
        .add_itxt_chunk("Description".to_owned(), description.to_owned())
        .map_err(|error| failed(error.to_string()))?;
    let mut writer = encoder.write_header().map_err(|error| failed(error.to_string()))?;
    writer.write_image_data(&rgb).map_err(|error| failed(error.to_string()))?;
    writer.finish().map_err(|error| failed(error.to_string()))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarse_picture_is_packed_tightly_and_both_show_the_same_ink() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="300" height="200" viewBox="0 0 300 200"><rect x="30" y="20" width="240" height="160" fill="#336699"/></svg>"##;
        let of = |dots| render("x", svg, "a box", dots).unwrap();
        let (coarse, fine) = (of(96.0), of(600.0));
        let read = |bytes: &[u8]| {
            let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut pixels).unwrap();
            let blue = pixels.chunks_exact(3).filter(|p| *p == [0x33, 0x66, 0x99]).count();
            let share = blue as f64 / f64::from(info.width * info.height);
            (info.width, info.height, share)
        };
        assert_eq!(read(&coarse).0, 300);
        assert_eq!((read(&fine).0, read(&fine).1), (1875, 1250));
        for picture in [&coarse, &fine] {
            assert!((read(picture).2 - 0.64).abs() < 0.01);
        }
        // The same picture packed quickly would be larger.
        let just_fine = of(COARSE_BELOW).len() as f64 / (COARSE_BELOW * COARSE_BELOW);
        let just_coarse =
            of(COARSE_BELOW - 1.0).len() as f64 / ((COARSE_BELOW - 1.0) * (COARSE_BELOW - 1.0));
        assert!(just_coarse < just_fine, "{just_coarse} {just_fine}");
        for refused in [0.0, 1e6] {
            assert!(render("x", svg, "", refused).is_err());
        }
    }
}
