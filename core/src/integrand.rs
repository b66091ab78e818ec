//! Given functions that are integrated over every cell.

mod tape;

use crate::cell::{Node, V3, v3};
use crate::frame::Frame;
use crate::{Error, Result};
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

pub use tape::{Batch, Tape};

/// Largest degree of a quadrature rule: 4096 nodes in a tetrahedron.
pub const LARGEST_DEGREE: u32 = 31;

/// A function of the caller's.
pub type Function = Arc<dyn Fn([f64; 3]) -> f64 + Send + Sync>;

/// A function f to be integrated over every restricted cell: ∫ f(x) dx, weighted by the domain's winding number.
///
/// Each cell is divided into tetrahedra, and on each a conical product of Gauss's and Jacobi's rules is used, whose weights are positive. What
/// is a polynomial up to the rule's degree is integrated exactly but for rounding: as a volume, times the largest magnitude that f's
/// terms take. What is not converges with the degree, and with the size of the cells, where it is smooth.
///
/// Where the cells are cut by a domain, f is integrated over convex pieces of them that reach **beyond the domain**, added and subtracted:
/// it is evaluated anywhere in the box of the domain's grid (which encloses the domain by up to half of its largest extent on every side), and
/// a kink at the domain's surface costs digits. It is not evaluated outside of that box, or of the box that the cells are restricted to.
#[derive(Clone)]
pub struct Integrand {
    degree: u32,
    kind: Kind,
}

#[derive(Clone)]
enum Kind {
    Polynomial { origin: [f64; 3], terms: Vec<([u32; 3], f64)> },
    Function(Function),
    Batches { columns: usize, function: Batch },
}

impl Integrand {
    /// The polynomial Σ c (x − o)^a (y − o)^b (z − o)^c of some terms `([a, b, c], c)`, in the caller's coordinates, `o` the `origin`. The rule's
    /// degree is its total degree, so that it is exact. An origin in or near the domain keeps the digits. Every backend that computes with
    /// double precision has it.
    ///
    /// # Errors
    /// `Input` where a number is not finite, or a term's degree is beyond [`LARGEST_DEGREE`].
    pub fn polynomial(origin: [f64; 3], terms: &[([u32; 3], f64)]) -> Result<Self> {
        if !origin.iter().all(|x| x.is_finite()) {
            return Err(Error::input(format!("integrand: its origin {origin:?} is not finite")));
        }
        if let Some((powers, c)) = terms.iter().find(|(_, c)| !c.is_finite()) {
            return Err(Error::input(format!("integrand: the coefficient {c} of the powers {powers:?} is not finite")));
        }
        let degree_of = |powers: &[u32; 3]| powers.iter().fold(0_u32, |sum, &power| sum.saturating_add(power));
        let degree = terms.iter().map(|(powers, _)| degree_of(powers)).max().unwrap_or(0);
        check_degree(degree)?;
        Ok(Self { degree, kind: Kind::Polynomial { origin, terms: terms.to_vec() } })
    }

    /// A function of the caller's coordinates, by a rule that is exact for polynomials up to `degree`. On the CPU alone: it is called from
    /// all threads, `(degree/2 + 1)³` times for each of some fifty tetrahedra of a cell, and must be finite.
    ///
    /// # Errors
    /// `Input` where the degree is beyond [`LARGEST_DEGREE`].
    pub fn function(degree: u32, function: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Result<Self> {
        check_degree(degree)?;
        Ok(Self { degree, kind: Kind::Function(Arc::new(function)) })
    }

    /// The same of a function that is called with many places at once, and has `columns` values at each: those at the first place, then
    /// those at the second and so on. So are the integrals: [`Output::integral`](crate::Output::integral) has the columns of the first site, then
    /// those of the second. Where an error is its answer, that is the evaluation's. Each cell is computed once to learn its places, and once for each
    /// column; which places are one batch depends on the sites alone, not on threads.
    ///
    /// # Errors
    /// `Input` where the degree is beyond [`LARGEST_DEGREE`], or there is no column.
    pub fn batches(
        degree: u32,
        columns: usize,
        function: impl Fn(&[[f64; 3]]) -> Result<Vec<f64>> + Send + Sync + 'static,
    ) -> Result<Self> {
        check_degree(degree)?;
        if columns == 0 {
            return Err(Error::input("integrand: a function without values: one column at least is needed"));
        }
        Ok(Self { degree, kind: Kind::Batches { columns, function: Arc::new(function) } })
    }

    /// How many values it has at a place.
    pub fn columns(&self) -> usize {
        match self.kind {
            Kind::Batches { columns, .. } => columns,
            _ => 1,
        }
    }

    /// Up to which total degree the rule is exact.
    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// Whether it is a function of the caller's, which only the CPU can call.
    pub fn is_function(&self) -> bool {
        !matches!(self.kind, Kind::Polynomial { .. })
    }

    /// How many cells are to be a batch, where its function is called with many places at once.
    #[doc(hidden)]
    pub fn batch(&self) -> Option<usize> {
        matches!(self.kind, Kind::Batches { .. }).then(|| tape::cells_at_once(self.degree))
    }

    /// The function, in the internal frame, of one such batch.
    #[doc(hidden)]
    pub fn taped(&self, frame: &Frame) -> Option<(FramedIntegrand, Tape)> {
        match &self.kind {
            Kind::Batches { columns, function } => Some(Tape::new(function, *columns, self.degree, frame)),
            _ => None,
        }
    }

    /// The function at `x` (the caller's coordinates), its first column; not a number where an error is the answer.
    pub fn value(&self, x: [f64; 3]) -> f64 {
        match &self.kind {
            Kind::Function(function) => function(x),
            Kind::Batches { columns, function } => first(function, *columns, x),
            Kind::Polynomial { origin, terms } => {
                let y: [f64; 3] = std::array::from_fn(|k| x[k] - origin[k]);
                let term = |(powers, c): &([u32; 3], f64)| (0..3).fold(*c, |t, k| t * y[k].powi(powers[k] as i32));
                terms.iter().map(term).sum()
            }
        }
    }

    /// The same function in the internal frame, with its rule. Called by backends, once an evaluation.
    ///
    /// # Errors
    /// `Input` where a coefficient is beyond all numbers in the frame's unit.
    #[doc(hidden)]
    pub fn framed(&self, frame: &Frame) -> Result<FramedIntegrand> {
        let frame = *frame;
        let mut framed = FramedIntegrand::of_polynomial(self.degree);
        match &self.kind {
            Kind::Function(function) => {
                let function = Arc::clone(function);
                let framed = Box::new(move |x: V3| function(frame.leave([x.x, x.y, x.z])));
                return Ok(FramedIntegrand::of_function(self.degree, framed));
            }
            // Place by place: for who does not take batches.
            Kind::Batches { columns, function } => {
                let (function, columns) = (Arc::clone(function), *columns);
                let framed = Box::new(move |x: V3| first(&function, columns, frame.leave([x.x, x.y, x.z])));
                return Ok(FramedIntegrand::of_function(self.degree, framed));
            }
            Kind::Polynomial { origin, terms } => {
                framed.origin = frame.enter(*origin);
                framed.coefficients = vec![0.0; coefficients(self.degree)];
                for (powers, c) in terms {
                    // A power of two: exact.
                    let scaled = powers.iter().fold(*c, |c, &power| c * frame.unit().powi(power as i32));
                    framed.coefficients[place_of(self.degree, *powers)] += scaled;
                }
                if !framed.coefficients.iter().all(|c| c.is_finite()) {
                    return Err(Error::input(
                        "integrand: a coefficient times the domain's extent to its power is beyond all numbers; choose another unit",
                    ));
                }
            }
        }
        Ok(framed)
    }
}

impl fmt::Debug for Integrand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            Kind::Function(_) => write!(f, "Integrand::function({}, …)", self.degree),
            Kind::Batches { columns, .. } => write!(f, "Integrand::batches({}, {columns}, …)", self.degree),
            Kind::Polynomial { origin, terms } => write!(f, "Integrand::polynomial({origin:?}, {terms:?})"),
        }
    }
}

/// The first column of a function of many places, at one.
fn first(function: &Batch, columns: usize, x: [f64; 3]) -> f64 {
    let values = function(&[x]).and_then(|values| tape::check_values(&values, 1, columns).map(|()| values[0]));
    values.unwrap_or(f64::NAN)
}

fn check_degree(degree: u32) -> Result<()> {
    if degree > LARGEST_DEGREE {
        return Err(Error::input(format!("integrand: degree {degree} is beyond {LARGEST_DEGREE}, the largest")));
    }
    Ok(())
}

/// A function of a place in the frame.
type FramedFunction = Box<dyn Fn(V3) -> f64 + Send + Sync>;

/// An [`Integrand`] in the internal frame, and its quadrature rule: what stores and devices have of it.
pub struct FramedIntegrand {
    nodes: Vec<Node>,
    degree: u32,
    origin: [f64; 3],
    coefficients: Vec<f64>,
    function: Option<FramedFunction>,
}

impl FramedIntegrand {
    /// A polynomial without terms.
    fn of_polynomial(degree: u32) -> Self {
        Self { nodes: rule(degree), degree, origin: [0.0; 3], coefficients: Vec::new(), function: None }
    }

    fn of_function(degree: u32, function: FramedFunction) -> Self {
        Self { function: Some(function), ..Self::of_polynomial(degree) }
    }

    /// The rule on a tetrahedron; weights sum to 1.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Total degree of the polynomial.
    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// The point that the polynomial's monomials are about.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// The coefficients of all monomials up to the degree n, as Horner's scheme takes them: for a from n down, for b from n − a down, for c
    /// from n − a − b down that of x^a y^b z^c.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// What a device takes: places and weight of each node, then the coefficients.
    pub fn table(&self) -> Vec<f64> {
        let nodes = self.nodes.iter().flat_map(|n| [n.place.x, n.place.y, n.place.z, n.weight]);
        nodes.chain(self.coefficients.iter().copied()).collect()
    }

    /// The function of the caller's, if it is one.
    pub(crate) fn function(&self) -> Option<&FramedFunction> {
        self.function.as_ref()
    }
}

impl fmt::Debug for FramedIntegrand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FramedIntegrand of degree {} with {} nodes", self.degree, self.nodes.len())
    }
}

/// Number of monomials up to a total degree.
fn coefficients(degree: u32) -> usize {
    let n = degree as usize;
    (n + 1) * (n + 2) * (n + 3) / 6
}

/// Where the coefficient of x^a y^b z^c stands.
fn place_of(degree: u32, [a, b, c]: [u32; 3]) -> usize {
    // Before it stand all with a larger power of x; of the same, all with a larger power of y; of the same, larger powers of z.
    let (i, j) = ((degree - a) as usize, (degree - a - b) as usize);
    i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + (degree - a - b - c) as usize
}

/// The conical product rule of a degree (Stroud 1971): with u, v, w of Jacobi's rules for the weights (1 − u)², 1 − v, 1 the points
/// (u, (1 − u)v, (1 − u)(1 − v)w) of the unit tetrahedron.
fn rule(degree: u32) -> Vec<Node> {
    let n = degree as usize / 2 + 1;
    let [first, second, third] = [2.0, 1.0, 0.0].map(|power| jacobi(n, power));
    let mut nodes = Vec::with_capacity(n * n * n);
    for &[u, share_u] in &first {
        for &[v, share_v] in &second {
            for &[w, share_w] in &third {
                let place = v3(u, (1.0 - u) * v, (1.0 - u) * (1.0 - v) * w);
                nodes.push(Node { place, weight: share_u * share_v * share_w });
            }
        }
    }
    nodes
}

/// Newton steps of a root at most: from the guesses below six suffice.
const STEPS: usize = 50;

/// The `n` nodes on (0, 1) of Gauss's rule with weight (1 − u)^`power`, and their shares of the weight's integral: exact to degree 2n − 1. The
/// nodes are roots of Jacobi's polynomial of parameters (`power`, 0) on (−1, 1), by Newton's method with those found divided out.
fn jacobi(n: usize, power: f64) -> Vec<[f64; 2]> {
    let mut roots: Vec<f64> = Vec::with_capacity(n);
    let mut rule = Vec::with_capacity(n);
    for k in 0..n {
        let mut x = -(PI * (2 * k + 1) as f64 / (2 * n) as f64).cos();
        if let Some(last) = roots.last() {
            x = 0.5 * (x + last);
        }
        for _ in 0..STEPS {
            let [value, slope] = jacobi_polynomial(n, power, x);
            let found: f64 = roots.iter().map(|root| 1.0 / (x - root)).sum();
            let step = value / (slope - value * found);
            x -= step;
            if step.abs() <= f64::EPSILON {
                break;
            }
        }
        let [_, slope] = jacobi_polynomial(n, power, x);
        roots.push(x);
        rule.push([0.5 * (1.0 + x), (power + 1.0) / ((1.0 - x * x) * slope * slope)]);
    }
    rule
}

/// Jacobi's polynomial of degree `n` and parameters (`a`, 0) at `x`, and its derivative.
fn jacobi_polynomial(n: usize, a: f64, x: f64) -> [f64; 2] {
    let (mut before, mut value) = (1.0, a + 1.0 + 0.5 * (a + 2.0) * (x - 1.0));
    for k in 2..=n {
        let k = k as f64;
        let c = 2.0 * k + a;
        let next = (c - 1.0) * (c * (c - 2.0) * x + a * a) * value - 2.0 * (k + a - 1.0) * (k - 1.0) * c * before;
        (before, value) = (value, next / (2.0 * k * (k + a) * (c - 2.0)));
    }
    let m = n as f64;
    let c = 2.0 * m + a;
    let slope = (m * (a - c * x) * value + 2.0 * (m + a) * m * before) / (c * (1.0 - x * x));
    [value, slope]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::UNIT_ROUNDOFF;

    /// ∫ x^a y^b z^c over the unit tetrahedron is a! b! c! / (a + b + c + 3)!.
    #[test]
    fn rules_are_exact_to_their_degree_and_positive() {
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        for degree in [0, 1, 2, 3, 4, 5, 8, 13, 20, LARGEST_DEGREE] {
            let nodes = rule(degree);
            let corner = |n: &Node| 1.0 - n.place.x - n.place.y - n.place.z;
            assert!(nodes.iter().all(|n| n.weight > 0.0 && n.place.x > 0.0 && n.place.y > 0.0 && n.place.z > 0.0));
            assert!(nodes.iter().all(|n| corner(n) > 0.0), "degree {degree}: a node is outside");
            for a in 0..=degree {
                for b in 0..=degree - a {
                    for c in [0, (degree - a - b) / 2, degree - a - b] {
                        let value = |n: &Node| {
                            let [x, y, z] = [n.place.x, n.place.y, n.place.z];
                            n.weight * x.powi(a as i32) * y.powi(b as i32) * z.powi(c as i32)
                        };
                        let found: f64 = nodes.iter().map(value).sum();
                        let wanted = 6.0 * factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3);
                        let bound = 64.0 * f64::from(degree + 1) * UNIT_ROUNDOFF * wanted;
                        assert!(
                            (found - wanted).abs() <= bound,
                            "degree {degree}, x^{a} y^{b} z^{c}: {found} {wanted}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn rules_are_no_better_than_their_degree() {
        for degree in [1, 3, 5] {
            let power = degree as i32 + 1;
            let found: f64 = rule(degree).iter().map(|n| n.weight * n.place.z.powi(power)).sum();
            let wanted = 6.0 / f64::from((degree + 2) * (degree + 3) * (degree + 4));
            assert!((found / wanted - 1.0).abs() > 1e-3, "degree {degree}: {found} {wanted}");
        }
    }

    #[test]
    fn coefficients_stand_in_the_order_of_horners_scheme() {
        for degree in 0..6 {
            let mut next = 0;
            for a in (0..=degree).rev() {
                for b in (0..=degree - a).rev() {
                    for c in (0..=degree - a - b).rev() {
                        assert_eq!(place_of(degree, [a, b, c]), next);
                        next += 1;
                    }
                }
            }
            assert_eq!(next, coefficients(degree));
        }
    }

    #[test]
    fn what_cannot_be_integrated_is_said() {
        let refused = |origin, terms: &[([u32; 3], f64)]| Integrand::polynomial(origin, terms).unwrap_err().to_string();
        assert!(refused([f64::NAN, 0.0, 0.0], &[]).contains("origin"));
        assert!(refused([0.0; 3], &[([0, 1, 0], f64::INFINITY)]).contains("[0, 1, 0]"));
        assert!(refused([0.0; 3], &[([16, 16, 0], 1.0)]).contains("32"));
        assert!(Integrand::function(LARGEST_DEGREE + 1, |_| 0.0).is_err());
        let large = Integrand::polynomial([0.0; 3], &[([7, 0, 0], 1.0)]).unwrap();
        assert!(large.framed(&Frame::of_box([0.0; 3], [1e60; 3])).is_err());
    }
}
