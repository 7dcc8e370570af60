//! Many coloured cells as one image inside an SVG file.

use super::colours::{STEPS, step_colour};
use super::sheet::Frame;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Palette index of a cell without a value: transparent, what lies below shows.
pub(super) const NOTHING: u8 = 0;

/// Palette index of a step of the colour map.
pub(super) fn index_of_step(step: usize) -> u8 {
    step.min(STEPS - 1) as u8 + 1
}

/// An image element that fills `frame` with `width * height` pixels, given as palette indices, the
/// top row first. Scaled without smoothing: a cell stays a sharp rectangle.
pub(super) fn image(frame: Frame, indices: &[u8], width: usize, height: usize) -> String {
    format!(
        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>\n",
        frame.left,
        frame.top,
        frame.width,
        frame.height,
        STANDARD.encode(png(indices, width, height)),
    )
}

fn png(indices: &[u8], width: usize, height: usize) -> Vec<u8> {
    let mut palette = vec![0; 3];
    for step in 0..STEPS {
        let colour = step_colour(step);
        palette.extend([colour.0, colour.1, colour.2]);
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette);
    encoder.set_trns(vec![0]);
    encoder.set_compression(png::Compression::Balanced);
    // Differences of palette indices mean nothing, so no filter; the compression sets one.
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header().expect("the image has pixels and a palette, and memory takes every byte");
    writer.write_image_data(indices).expect("there is one index per pixel, and memory takes every byte");
    writer.finish().expect("memory takes every byte");
    file
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Width, height and RGBA pixels of the `nth` image in a picture.
    pub fn decoded(svg: &str, nth: usize) -> (u32, u32, Vec<[u8; 4]>) {
        let start = "data:image/png;base64,";
        let (_, rest) = svg.split_at(svg.match_indices(start).nth(nth).expect("an image").0);
        let encoded = rest[start.len()..].split('"').next().expect("the text ends");
        let file = STANDARD.decode(encoded).expect("base64");
        let mut decoder = png::Decoder::new(std::io::Cursor::new(file));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().expect("a PNG file");
        let mut bytes = vec![0; reader.output_buffer_size().expect("it fits into memory")];
        let info = reader.next_frame(&mut bytes).expect("pixels");
        let pixels = bytes[..info.buffer_size()].chunks_exact(4);
        let pixels = pixels.map(|p| [p[0], p[1], p[2], p[3]]).collect();
        (info.width, info.height, pixels)
    }
}
