//! A polynomial as people write it: `2*x^2*y - z + 1`.

use laguerre::Integrand;

/// Reads a polynomial in the coordinates x, y, z.
pub(crate) fn parse_polynomial(text: &str) -> Result<Integrand, String> {
    let mut rest = Rest(text);
    let mut terms = Vec::new();
    let mut sign = if rest.takes("-") { -1.0 } else { 1.0 };
    loop {
        let mut term = ([0; 3], sign);
        rest.factor(&mut term)?;
        while rest.takes("*") {
            rest.factor(&mut term)?;
        }
        terms.push(term);
        sign = match () {
            () if rest.0.trim().is_empty() => break,
            () if rest.takes("+") => 1.0,
            () if rest.takes("-") => -1.0,
            () => return Err(rest.strange()),
        };
    }
    Integrand::polynomial([0.0; 3], &terms).map_err(|e| e.to_string().replace("integrand: ", ""))
}

/// What is still to be read.
struct Rest<'t>(&'t str);

impl Rest<'_> {
    /// Whether `what` is next; it is taken then.
    fn takes(&mut self, what: &str) -> bool {
        let rest = self.0.trim_start().strip_prefix(what);
        self.0 = rest.unwrap_or(self.0);
        rest.is_some()
    }

    /// Multiplies a term, powers and coefficient, by a number or by a power of a coordinate.
    fn factor(&mut self, (powers, coefficient): &mut ([u32; 3], f64)) -> Result<(), String> {
        if let Some(axis) = ["x", "y", "z"].iter().position(|name| self.takes(name)) {
            let power = if self.takes("^") || self.takes("**") { self.whole()? } else { 1 };
            powers[axis] = powers[axis].saturating_add(power);
            return Ok(());
        }
        let text = self.0.trim_start();
        // The longest beginning that is a number; so that `1e-3` is one, and `1-3` is not.
        let ends = (1..=text.len()).rev().filter(|&end| text.is_char_boundary(end));
        let begins = text.starts_with(|c: char| c.is_ascii_digit() || c == '.');
        let number = ends.filter(|_| begins).find_map(|end| Some((end, text[..end].parse::<f64>().ok()?)));
        let (end, number) = number.ok_or_else(|| self.strange())?;
        *coefficient *= number;
        self.0 = &text[end..];
        Ok(())
    }

    fn whole(&mut self) -> Result<u32, String> {
        let text = self.0.trim_start();
        let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
        let whole = text[..end].parse().map_err(|_| self.strange())?;
        self.0 = &text[end..];
        Ok(whole)
    }

    fn strange(&self) -> String {
        const NEEDED: &str = "a polynomial in x, y, z is needed, such as 2*x^2*y - z + 1";
        match self.0.trim() {
            "" => format!("it ends too soon; {NEEDED}"),
            rest => format!("not understood from '{}' on; {NEEDED}", rest.chars().take(20).collect::<String>()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_read_as_they_are_meant() {
        let at = [0.5, -3.0, 7.0];
        let [x, y, z] = at;
        for (text, value, degree) in [
            ("1", 1.0, 0),
            ("-x", -x, 1),
            ("2*x^2*y - z + 1", 2.0 * x * x * y - z + 1.0, 3),
            (" 2 * x ** 2*y-z+1 ", 2.0 * x * x * y - z + 1.0, 3),
            ("1e-3*z*0.5*z-.5", 0.5e-3 * z * z - 0.5, 2),
            ("x*y*x", x * x * y, 3),
            ("1e1-3", 7.0, 0),
            ("x^0", 1.0, 0),
        ] {
            let read = parse_polynomial(text).unwrap();
            assert!((read.value(at) - value).abs() < 1e-14 && read.degree() == degree, "{text}: {}", read.value(at));
            assert!(!read.is_function());
        }
    }

    #[test]
    fn what_is_no_polynomial_is_said() {
        let wrong = |text: &str| parse_polynomial(text).unwrap_err();
        let needed = "; a polynomial in x, y, z is needed, such as 2*x^2*y - z + 1";
        for text in ["", " ", "x+", "x*", "x^", "-"] {
            assert_eq!(wrong(text), format!("it ends too soon{needed}"), "{text:?}");
        }
        for (text, from) in [
            ("sin(x)", "sin(x)"),
            ("2x", "x"),
            ("x^-1", "-1"),
            ("x^0.5", ".5"),
            ("x/2", "/2"),
            ("(x)", "(x)"),
            ("x + é", "é"),
            ("1 + inf", "inf"),
            ("2**3", "*3"),
            ("x^99999999999", "99999999999"),
        ] {
            assert_eq!(wrong(text), format!("not understood from '{from}' on{needed}"), "{text:?}");
        }
        assert_eq!(wrong("x^20*y^20"), "degree 40 is beyond 31, the largest");
        assert!(wrong("1e999*x").contains("is not finite"));
    }
}
