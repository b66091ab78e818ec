//! The damped Newton: from a state without empty cells to the masses asked for.

use laguerre_core::summation::chunks;
use std::ops::ControlFlow;
use std::ops::Range;
use std::time::Instant;

use laguerre_core::algebra::{Algebra, Held, Kept};
use laguerre_core::diagram::Container;
use laguerre_core::rows::places;
use laguerre_core::{Backend, Error, ErrorKind, Laplacian, Output, PowerDiagram, Request, Result};

use super::host::HOST;
use super::laplacian::{of_masses, of_volumes};
use super::limited::Limits;
use super::multigrid::Multigrid;
use super::sparse::{center, center_parts, norm};
use super::system::{Aim, System};
use super::{End, Iteration, Options, bridge, limited, mend, request, start};
use crate::density::{Density, is_of_density};
use crate::vectors::{for_each, largest, map, sum};

/// Weights, and what they give.
pub(super) struct State {
    pub(super) weights: Vec<f64>,
    pub(super) output: Output,
    pub(super) masses: Vec<f64>,
    /// What these masses were multiplied by.
    pub(super) scale: f64,
    /// Least of the masses.
    pub(super) least: f64,
    /// Largest `|mass / target − 1|`.
    pub(super) residual: f64,
    /// `‖target − mass‖`.
    pub(super) error: f64,
}

/// Where to go from a state.
enum Direction<'a> {
    Newton(Box<System<'a>>),
    /// The cells fall into parts that do not touch, and this (true for each of its sites) has to gain mass from the others.
    Apart(Vec<bool>),
}

/// What does not change from step to step.
pub(super) struct Problem<'a> {
    pub(super) backend: &'a dyn Backend,
    pub(super) diagram: &'a mut PowerDiagram,
    pub(super) density: Density,
    pub(super) tolerance: f64,
    pub(super) request: Request,
    /// Whether second moments are asked for that `request` does not have; and whether the next diagram, likely the last, is to have them.
    lacks_moments: bool,
    adds_moments: bool,
    pub(super) targets: Vec<f64>,
    pub(super) least_target: f64,
    /// Mass per volume where the domain has any.
    pub(super) mean_density: f64,
    /// The power of two near the mean target: masses here are in units of it, so that their squares are in range.
    pub(super) unit: f64,
    /// No cell's mass may fall below this, half of what the first state or the targets had; 0 until there is a first state.
    pub(super) bound: f64,
    /// The sites so that neighbours in space are neighbours in memory, and where each stands there: as the first diagram has it.
    pub(super) order: Vec<u32>,
    pub(super) place: Vec<u32>,
    /// The targets in that order, and the number of orders that there were.
    ordered: Vec<f64>,
    orders: usize,
    /// That of the last step, whose coarse levels may serve for the next.
    multigrid: Option<Multigrid<'a>>,
    /// The last step that was taken.
    pub(super) step: f64,
    /// Where the end was that no mass came to a part from others: true for each of its sites.
    pub(super) stuck: Option<Vec<bool>>,
    /// Limited steps that were tried.
    pub(super) limited_steps: usize,
    pub(super) evaluations: usize,
    pub(super) seconds: f64,
}

/// Whether an error says that weights are out of range: a step was too long.
pub(super) fn is_out_of_range(error: &Error) -> bool {
    error.kind() == ErrorKind::Input && !is_of_density(error)
}

/// A Newton step is not made shorter than this, nor so short that no weight changes by more than a rounding of the largest.
const SHORTEST_STEP: f64 = 1.0 / (1_u64 << 24) as f64;
/// The linear system is solved to this part of its right-hand side at least (with 0.1 steps have to be shorter); closer to the end to a
/// part of the error's own relative size, which leaves convergence quadratic: with all of it a million white sites took a step more.
const LOOSEST: f64 = 0.01;
const PART_OF_ERROR: f64 = 0.1;

/// What a step near the end leaves, of the square of the residual before it (0.15 to 0.28 measured); and the diagram after a step has second moments where it
/// is likely to be the last, or to leave no more than so many times the tolerance. (Of a million particles they cost a tenth of the diagram; where they
/// are missing at the end it is evaluated once more.)
const FIRST_STEP: f64 = 0.25;
const MOST_LIKELY: f64 = 4.0;

impl<'a> Problem<'a> {
    /// For these masses, which sum to the domain's.
    pub(super) fn new(
        backend: &'a dyn Backend,
        diagram: &'a mut PowerDiagram,
        mut targets: Vec<f64>,
        options: &Options,
    ) -> Result<Self> {
        let unit = (targets.iter().sum::<f64>() / targets.len() as f64).log2().round().exp2();
        targets.iter_mut().for_each(|target| *target /= unit);
        let request = request(options, backend, diagram.positions().len());
        let mean_density = match diagram.container()? {
            Container::Domain(domain) => domain.mean_density(),
            Container::Box(..) => 1.0,
        };
        Ok(Self {
            backend,
            diagram,
            density: options.density.clone(),
            tolerance: options.tolerance,
            lacks_moments: options.second_moments && !request.second_moments(),
            adds_moments: false,
            request,
            mean_density,
            least_target: targets.iter().copied().fold(f64::INFINITY, f64::min),
            targets,
            unit,
            bound: 0.0,
            order: Vec::new(),
            place: Vec::new(),
            ordered: Vec::new(),
            orders: 0,
            multigrid: None,
            step: 1.0,
            stuck: None,
            limited_steps: 0,
            evaluations: 0,
            seconds: 0.0,
        })
    }

    /// Newton steps from a state without empty cells, until the tolerance is met or something else ends it. `on_iteration` sees each, and
    /// the start, which began at `begin`.
    ///
    /// # Errors
    /// What the backend says, but that someone wants this to stop.
    pub(super) fn run(
        &mut self,
        mut state: State,
        mut begin: Instant,
        most_iterations: usize,
        on_iteration: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<(State, End)> {
        self.bound = state.least.min(self.least_target) / 2.0;
        let mut iteration = Iteration { residual: state.residual, ..self.take_costs(begin) };
        let mut before = state.residual;
        loop {
            let goes_on = on_iteration(&iteration).is_continue();
            if state.residual <= self.tolerance {
                return Ok((state, End::Converged));
            }
            if !goes_on {
                return Ok((state, End::Interrupted));
            }
            if iteration.number == most_iterations {
                return Ok((state, End::MostIterations));
            }
            begin = Instant::now();
            // (At the end the factor by which the residual falls is the square of the last one, if there is one.)
            let likely = match iteration.number {
                0 => FIRST_STEP * state.residual * state.residual,
                _ => state.residual * (state.residual / before).powi(2),
            };
            before = state.residual;
            self.adds_moments = self.lacks_moments && likely <= MOST_LIKELY * self.tolerance;
            let (step, linear_iterations, next) = match self.next(&mut state) {
                Ok(Some(next)) => next,
                Ok(None) => return Ok((state, End::Stalled)),
                Err(error) if error.kind() == ErrorKind::Interrupted => return Ok((state, End::Interrupted)),
                Err(error) => return Err(error),
            };
            state = next;
            let number = iteration.number + 1;
            iteration =
                Iteration { number, residual: state.residual, step, linear_iterations, ..self.take_costs(begin) };
        }
    }

    /// The state after a step from `state`, which loses its facets, with the part of the step that leads there and the iterations that it took;
    /// `None` where no step makes the error smaller.
    pub(super) fn next(&mut self, state: &mut State) -> Result<Option<(f64, usize, State)>> {
        let is_kept = state.output.kept().is_some();
        let direction = self.direction(state)?;
        match self.follow(state, direction) {
            // (As in `direction`.)
            Err(error) if is_kept && error.kind() == ErrorKind::Device => {
                self.evaluate_for_host(state)?;
                let direction = self.direction_by(state)?;
                self.follow(state, direction)
            }
            other => other,
        }
    }

    /// The state after a step in a direction.
    fn follow(&mut self, state: &State, direction: Direction<'a>) -> Result<Option<(f64, usize, State)>> {
        match direction {
            Direction::Newton(system) => self.advance(state, *system),
            Direction::Apart(part) => {
                let next = bridge::bridge(self, state, &part)?;
                self.stuck = next.is_none().then_some(part);
                Ok(next.map(|next| (0.0, 0, next)))
            }
        }
    }

    /// The diagram of some weights.
    pub(super) fn evaluate(&mut self, weights: Vec<f64>) -> Result<State> {
        let begin = Instant::now();
        self.diagram.set_weights(&weights)?;
        let request = self.request.clone();
        let request = if self.adds_moments { request.with_second_moments() } else { request };
        let output = self.density.evaluate(self.backend, self.diagram, &request)?;
        self.seconds += begin.elapsed().as_secs_f64();
        self.evaluations += 1;
        self.stand_as(output.kept().map(Kept::order).or(output.laplacian().map(Laplacian::order)))?;
        let missing = || Error::new(ErrorKind::Device, "the backend gave no integrals though asked to");
        let mut masses = self.density.masses(&output).ok_or_else(missing)?;
        let scale = self.scale(&masses)?;
        for_each(&mut masses, |_, mass| *mass *= scale);
        let least_of = |part: Range<usize>| masses[part].iter().copied().fold(f64::INFINITY, f64::min);
        let least = chunks(masses.len(), least_of).into_iter().fold(f64::INFINITY, f64::min);
        let residual = largest(masses.len(), |i| (masses[i] / self.targets[i] - 1.0).abs());
        let error = sum(masses.len(), |i| (self.targets[i] - masses[i]).powi(2)).sqrt();
        Ok(State { weights, output, masses, scale, least, residual, error })
    }

    /// What masses are multiplied by: to be in the unit, and those of a quadrature to sum to the targets'. They do so up to its error alone, which
    /// differs from diagram to diagram, and no weights would make up for that.
    fn scale(&self, masses: &[f64]) -> Result<f64> {
        match self.density {
            Density::Uniform | Density::Linear { .. } => Ok(self.unit.recip()),
            Density::Function(_) => {
                let scale = sum(masses.len(), |i| self.targets[i]) / sum(masses.len(), |i| masses[i]);
                match scale > 0.0 && scale.is_finite() {
                    true => Ok(scale),
                    false => Err(Error::input("the quadrature of the density gives no mass: give a higher degree")),
                }
            }
        }
    }

    /// Completes the output of the last state that was evaluated: with what is asked for of it, and with facets where they are to say why it stalled.
    ///
    /// # Errors
    /// What the backend says.
    pub(super) fn complete(&mut self, state: &mut State, end: End, options: &Options) -> Result<()> {
        let says_why = end == End::Stalled && !options.facets;
        match self.complete_with(state, options.facets || says_why, options) {
            // (Facets that nobody has asked for may be more than there is memory for: the weights are worth more than why they are no better.)
            Err(error) if says_why && error.kind() != ErrorKind::Interrupted => {
                self.evaluate_again(state)?;
                self.complete_with(state, false, options)
            }
            other => other,
        }
    }

    fn complete_with(&mut self, state: &mut State, wants_facets: bool, options: &Options) -> Result<()> {
        let needs_facets = wants_facets && state.output.facets().is_none();
        let kept = state.output.kept().zip(self.backend.algebra());
        let stays = options.keeps_laplacian && kept.is_some();
        let mut laplacian = match kept.filter(|_| options.laplacian) {
            Some(_) if stays => None,
            Some((kept, algebra)) => algebra.read_laplacian(kept)?,
            None => state.output.take_laplacian(),
        };
        let needs_laplacian = options.laplacian && laplacian.is_none() && !stays;
        let is_function = matches!(self.density, Density::Function(_));
        let needs_moments = options.second_moments && (is_function || state.output.second_moment().is_none());
        if needs_facets || needs_laplacian || needs_moments {
            let asked = || Request::moments().with_weights_to_differ();
            let request = if is_function { self.request.clone() } else { asked() };
            let request = if wants_facets { request.with_facets() } else { request };
            let request = if needs_laplacian { request.with_laplacian() } else { request };
            let request = if stays { request.with_laplacian_kept() } else { request };
            let request = if options.second_moments { request.with_second_moments() } else { request };
            self.diagram.set_weights(&state.weights)?;
            state.output = match needs_moments && is_function {
                true => self.density.evaluate_moments(self.backend, self.diagram, &request)?,
                false => self.density.evaluate(self.backend, self.diagram, &request)?,
            };
            laplacian = laplacian.or(state.output.take_laplacian());
        }
        if let Some(laplacian) = laplacian.filter(|_| options.laplacian) {
            state.output.put_laplacian(laplacian);
        }
        Ok(())
    }

    /// Takes the order of a diagram's rows, which is the same for all of these sites; where it tells none, that along the curve.
    ///
    /// # Errors
    /// `Input` where sites coincide.
    fn stand_as(&mut self, order: Option<&[u32]>) -> Result<()> {
        let is_whole = order.is_some_and(|order| order.len() == self.diagram.positions().len());
        let order = match order {
            Some(order) if is_whole && order == self.order => return Ok(()),
            Some(order) if is_whole => order.to_vec(),
            None if !self.order.is_empty() => return Ok(()),
            _ => {
                let sorted = self.diagram.prepare()?.sites;
                start::check_coincident(self.diagram.positions(), &sorted)?;
                sorted.order().to_vec()
            }
        };
        if order != self.order {
            self.place = places(&order, order.len());
            self.orders += 1;
            self.ordered = map(order.len(), |row| self.targets[order[row] as usize]);
            self.order = order;
            self.multigrid = None;
        }
        Ok(())
    }

    /// The matrix of a state, which loses what it is made of, to make room, and who computes with it.
    fn matrix(&mut self, state: &mut State) -> Result<(&'a dyn Algebra, Held)> {
        let kept = state.output.kept().zip(self.backend.algebra());
        if let Some((kept, algebra)) = kept
            && let Some(matrix) = algebra.laplacian(kept, 0.5 / self.unit)?
        {
            return Ok((algebra, matrix));
        }
        if state.output.kept().is_some() {
            // Someone else has used the backend since.
            self.evaluate_for_host(state)?;
        }
        let matrix = match (state.output.take_laplacian(), state.output.take_facets()) {
            (Some(laplacian), _) => of_volumes(&laplacian, self.unit),
            (None, Some(facets)) => {
                let bounds = match self.diagram.container()? {
                    Container::Box(lo, hi) => Some([lo, hi]),
                    Container::Domain(_) => None,
                };
                of_masses(&facets, &self.density, bounds, &self.order, &self.place, state.scale)?
            }
            (None, None) => return Err(Error::new(ErrorKind::Device, "the backend gave no facets though asked to")),
        };
        Ok((&HOST, HOST.matrix(matrix.into_rows())?))
    }

    /// Evaluates a state once more, its Laplacian for the host, as from now on.
    fn evaluate_for_host(&mut self, state: &mut State) -> Result<()> {
        self.request = self.request.clone().with_laplacian();
        self.multigrid = None;
        self.evaluate_again(state)
    }

    fn evaluate_again(&mut self, state: &mut State) -> Result<()> {
        *state = self.evaluate(state.weights.clone())?;
        Ok(())
    }

    /// Where to go from a state, whose facets are taken out. What a device has no memory for, the host has.
    fn direction(&mut self, state: &mut State) -> Result<Direction<'a>> {
        let is_kept = state.output.kept().is_some();
        match self.direction_by(state) {
            Err(error) if is_kept && error.kind() == ErrorKind::Device => {
                self.evaluate_for_host(state)?;
                self.direction_by(state)
            }
            other => other,
        }
    }

    fn direction_by(&mut self, state: &mut State) -> Result<Direction<'a>> {
        let (algebra, matrix) = self.matrix(state)?;
        let limits = Limits::new(self, state, algebra)?;
        let mut multigrid = match self.multigrid.take().filter(|last| std::ptr::addr_eq(last.algebra(), algebra)) {
            Some(last) => last.renewed(matrix)?,
            None => Multigrid::new(algebra, matrix)?,
        };
        loop {
            multigrid.end_at(self.orders, &self.ordered)?;
            let aim = match self.aim(state, &multigrid)? {
                Ok(aim) => aim,
                Err(part) => return Ok(Direction::Apart(part)),
            };
            let (solved, newton) = aim.solved(multigrid)?;
            if newton.is_solved || !solved.is_of_another() {
                return Ok(Direction::Newton(Box::new(System { multigrid: solved, limits, aim, newton })));
            }
            multigrid = solved.made_anew()?;
        }
    }

    /// What a step is to come to; where the cells are in parts that do not touch, and some have to gain mass from the others, the sites of these.
    fn aim(&self, state: &State, multigrid: &Multigrid<'_>) -> Result<std::result::Result<Aim, Vec<bool>>> {
        let (mut missing, mut slope) = self.missing(state);
        if let Some((parts, count)) = multigrid.parts()? {
            let exact: Vec<f64> =
                self.order.iter().zip(&self.ordered).map(|(&i, target)| target - state.masses[i as usize]).collect();
            let (mut lacking, mut asked) = (vec![0.0; count], vec![0.0; count]);
            for (row, &part) in parts.iter().enumerate() {
                lacking[part as usize] += exact[row];
                asked[part as usize] += self.ordered[row];
            }
            let share = |part: &usize| lacking[*part] / asked[*part];
            // Of the part that is the farthest off: what it has too much the others lack together.
            let farthest = (0..count).max_by(|a, b| share(a).abs().total_cmp(&share(b).abs())).unwrap_or(0);
            if share(&farthest).abs() > self.tolerance {
                let (farthest, lacks) = (farthest as u32, share(&farthest) > 0.0);
                return Ok(Err(self.place.iter().map(|&row| (parts[row as usize] == farthest) == lacks).collect()));
            }
            // Each part for itself: its constants are in the kernel.
            missing = exact;
            slope = 1.0;
            center_parts(&mut missing, &parts, count);
        }
        let relative = LOOSEST.min(PART_OF_ERROR * state.error / norm(&self.ordered));
        Ok(Ok(Aim { missing, tolerance: self.tolerance, relative, slope }))
    }

    /// What a step is to add to each mass, in `order`, and how fast that makes the error fall: by `slope·t` of itself with a small part t
    /// of the step.
    ///
    /// It is `target − mass` where there is too much. Where there is too little, a mass that is far from its target would be aimed at by its
    /// tangent, though it grows much faster: like the third power of the weight, where a cell has only just appeared (along a
    /// line of weights its cube root is concave, by Brunn and Minkowski). There it is the tangent of the cube root that is followed to
    /// the target, `3 m ((t/m)^⅓ − 1)`, which is less, and the others give as much less. Both are one at the target, up to what is
    /// quadratic in the error, so that the end stays quadratic; far from it, steps are many times longer.
    fn missing(&self, state: &State) -> (Vec<f64>, f64) {
        let n = self.ordered.len();
        let lacking = |row: usize| self.ordered[row] - state.masses[self.order[row] as usize];
        let mut missing: Vec<f64> = map(n, |row| {
            let (t, m) = (self.ordered[row], state.masses[self.order[row] as usize]);
            if m < t { 3.0 * m * ((t / m).cbrt() - 1.0) } else { t - m }
        });
        // (All sums in one turn: a million numbers are gone through in 0.5 to 1 ms by 16 threads.)
        let parts = chunks(n, |part| {
            let (mut more, mut less) = ([0.0; 2], [0.0; 2]);
            for row in part {
                let [sum, product] = if missing[row] < 0.0 { &mut less } else { &mut more };
                *sum += missing[row];
                *product += lacking(row) * missing[row];
            }
            [more, less]
        });
        let total = |side: usize, which: usize| parts.iter().map(|part| part[side][which]).sum::<f64>();
        let share = total(0, 0) / -total(1, 0);
        if !share.is_finite() {
            return (missing, 1.0);
        }
        for_each(&mut missing, |_, m| *m *= if *m < 0.0 { share } else { 1.0 });
        (missing, (total(0, 1) + share * total(1, 1)) / (state.error * state.error))
    }

    /// The next state: which part of a step leads there, and the iterations that it took. Newton's step if it is good as it is, once that
    /// failed a limited one, and where that fails too Newton's, shortened.
    fn advance(&mut self, state: &State, mut system: System<'a>) -> Result<Option<(f64, usize, State)>> {
        let (mut iterations, slope) = (system.newton.iterations, system.aim.slope);
        let solution = &system.newton.solution;
        let newton: Vec<f64> = map(self.place.len(), |i| solution[self.place[i] as usize]);
        if limited::is_to_be(self, &system)? {
            if self.limited_steps == 0
                && let Some((step, next)) = self.damped(state, &newton, slope, 1.0)?
            {
                self.multigrid = Some(system.multigrid.resting(newton.len()));
                return Ok(Some((step, iterations, next)));
            }
            let limited;
            (limited, system) = limited::step(self, state, system)?;
            iterations += limited.iterations;
            if let Some((step, next)) = limited.reached {
                self.multigrid = Some(system.multigrid.resting(newton.len()));
                return Ok(Some((step, iterations, next)));
            }
        }
        self.multigrid = Some(system.multigrid.resting(newton.len()));
        let found = self.damped(state, &newton, slope, SHORTEST_STEP)?;
        Ok(found.map(|(step, next)| {
            self.step = step;
            (step, iterations, next)
        }))
    }

    /// The longest step, of twice the last one halved again and again, after which no cell has too little mass and the error has fallen
    /// enough; none shorter than `shortest`.
    fn damped(&mut self, state: &State, direction: &[f64], slope: f64, shortest: f64) -> Result<Option<(f64, State)>> {
        let size = |x: &[f64]| largest(x.len(), |i| x[i].abs());
        let (reach, rounding) = (size(direction), f64::EPSILON * size(&state.weights));
        let mut step = (2.0 * self.step).min(1.0);
        while step >= shortest && step * reach > rounding {
            let mut weights = map(direction.len(), |i| state.weights[i] + step * direction[i]);
            center(&mut weights);
            match mend::step(self, weights) {
                Ok(next) if next.residual <= self.tolerance => return Ok(Some((step, next))),
                Ok(next) if next.least >= self.bound && next.error <= (1.0 - slope * step / 2.0) * state.error => {
                    return Ok(Some((step, next)));
                }
                Ok(_) => {}
                // Weights out of range: much too far.
                Err(error) if is_out_of_range(&error) => {}
                Err(error) => return Err(error),
            }
            step /= 2.0;
        }
        Ok(None)
    }

    /// What was spent since `begin`, and the counters at zero again.
    pub(super) fn take_costs(&mut self, begin: Instant) -> Iteration {
        let diagram_seconds = std::mem::take(&mut self.seconds);
        Iteration {
            diagram_evaluations: std::mem::take(&mut self.evaluations),
            diagram_seconds,
            solver_seconds: begin.elapsed().as_secs_f64() - diagram_seconds,
            ..Iteration::default()
        }
    }
}
