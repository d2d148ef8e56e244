//! Quantities on the command line.

use std::time::Duration;

/// `60s`, `500ms`, `2min`; a bare number counts seconds.
pub fn time(text: &str) -> Result<Duration, String> {
    let (number, unit) = split(text)?;
    let factor = match unit {
        "" | "s" => 1.0,
        "ms" => 1e-3,
        "min" => 60.0,
        "h" => 3600.0,
        other => return Err(format!("`{other}` is no unit of time: ms, s, min or h")),
    };
    Duration::try_from_secs_f64(number * factor).map_err(|e| e.to_string())
}

/// `2GB`, `500MB`, `64kB`; a bare number counts bytes.
pub fn data(text: &str) -> Result<u64, String> {
    let (number, unit) = split(text)?;
    let factor = match unit.to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "kib" => 1024.0,
        "mib" => 1_048_576.0,
        "gib" => 1_073_741_824.0,
        _ => return Err(format!("`{unit}` is no unit of data: kB, MB or GB")),
    };
    Ok((number * factor) as u64)
}

fn split(text: &str) -> Result<(f64, &str), String> {
    let text = text.trim();
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let number: f64 = text[..end].parse().map_err(|_| format!("`{text}` begins with no number"))?;
    Ok((number, text[end..].trim()))
}
