//! What options may be given: how each is read, and what is said of a wrong one.

use laguerre::DeviceChoice;
use laguerre::engine::backend::MOST_THREADS;
use laguerre::limits::LARGEST_COORDINATE;

use super::Corners;

/// Sites that the program makes at most.
pub(super) const MOST_SITES: u32 = 1 << 31;

/// A count as people write it: 100000, 100_000 or 1e5.
pub(crate) fn parse_count<const LEAST: u32, const MOST: u32>(text: &str) -> Result<u32, String> {
    let digits = text.replace('_', "");
    let is_number = text.starts_with(|c: char| c.is_ascii_digit()) && !text.ends_with('_') && !text.contains("__");
    let count = match digits.parse::<u32>() {
        Ok(count) => Some(count),
        Err(_) if !digits.contains(['e', 'E']) => None,
        Err(_) => {
            digits.parse::<f64>().ok().filter(|x| x.fract() == 0.0 && *x <= f64::from(u32::MAX)).map(|x| x as u32)
        }
    };
    count
        .filter(|count| is_number && (LEAST..=MOST).contains(count))
        .ok_or_else(|| format!("a whole number from {LEAST} to {MOST} is needed, such as 100000, 100_000 or 1e5"))
}

pub(super) fn parse_box(text: &str) -> Result<Corners, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|word| match word.trim().parse::<f64>() {
            Ok(x) if x.abs() <= LARGEST_COORDINATE => Ok(x),
            _ => Err(format!("'{}' is not a number within ±{LARGEST_COORDINATE:e}", word.trim())),
        })
        .collect::<Result<_, _>>()?;
    let [x0, y0, z0, x1, y1, z1] = *numbers.as_slice() else {
        return Err(format!("{} numbers; 6 are needed: x0,y0,z0,x1,y1,z1", numbers.len()));
    };
    let corners = Corners { lo: [x0, y0, z0], hi: [x1, y1, z1] };
    match (0..3).find(|&k| corners.lo[k] >= corners.hi[k]) {
        Some(k) => {
            Err(format!("its {} range is empty: give the minimum corner, then the maximum corner", ["x", "y", "z"][k]))
        }
        None => Ok(corners),
    }
}

pub(super) fn parse_epsilon(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(epsilon) if epsilon.is_finite() && epsilon >= 0.0 => Ok(epsilon),
        _ => Err("a finite number, 0 or larger, is needed".into()),
    }
}

pub(super) fn parse_percent(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(percent) if percent > 0.0 && percent <= 100.0 => Ok(percent),
        _ => Err("a number above 0 and up to 100 is needed".into()),
    }
}

pub(super) fn parse_devices(text: &str) -> Result<DeviceChoice, String> {
    if text == "all" {
        return Ok(DeviceChoice::All);
    }
    let numbers = text.split(',').map(|word| word.trim().parse()).collect::<Result<_, _>>();
    numbers.map(DeviceChoice::Numbers).map_err(|_| "numbers separated by commas, or all, are needed".into())
}

pub(super) fn parse_threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(threads @ 1..=MOST_THREADS) => Ok(threads),
        _ => Err(format!("a whole number from 1 to {MOST_THREADS} is needed")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_written_as_people_do() {
        let count = parse_count::<1, MOST_SITES>;
        for text in ["100000", "100_000", "1e5", "1E5", "1.0e5", "10e+4", "1_000e2"] {
            assert_eq!(count(text), Ok(100_000), "{text}");
        }
        assert_eq!((count("1"), count("2147483648"), count("1.5e1")), (Ok(1), Ok(MOST_SITES), Ok(15)));
        for text in [
            "",
            "0",
            "1.5",
            "1.55e1",
            "1e-1",
            "1e10",
            "2147483649",
            "-1e5",
            "_1",
            "1_",
            "1__0",
            "nan",
            "inf",
            "1e",
            "e5",
            "1,000",
        ] {
            let said = count(text).unwrap_err();
            assert_eq!(said, "a whole number from 1 to 2147483648 is needed, such as 100000, 100_000 or 1e5", "{text}");
        }
    }

    #[test]
    fn boxes_are_six_numbers_in_order() {
        let corners = parse_box("-1,0,0, 1,2,3e0").unwrap();
        assert_eq!(corners, Corners { lo: [-1.0, 0.0, 0.0], hi: [1.0, 2.0, 3.0] });
        assert!(parse_box("0,0,0,1,1").unwrap_err().starts_with("5 numbers"));
        assert!(parse_box("0,0,0,1,1,inf").unwrap_err().starts_with("'inf' is not a number within"));
        assert!(parse_box("0,0,0,1,0,1").unwrap_err().starts_with("its y range"));
    }
}
