//! glTF 2.0, binary (`.glb`): a header, a chunk of JSON that says what is where, and a chunk of numbers. The JSON is a dozen lines of fixed shape,
//! so it is written as text: the crate `gltf-json` would bring eight others for it.

use std::collections::HashMap;
use std::io::{self, Write};

use crate::geometry::{Beyond, Geometry};
use crate::{CellStatus, Observer, Output, PowerDiagram, Result};

/// The cells as triangles: of each cell its own corners, with a colour that none of its neighbours has.
pub(super) struct Glb {
    /// Of each cell that is not empty its site, its colour and its number of corners.
    cells: Vec<(u32, [u8; 4], usize)>,
    /// The corners of all cells, as points of the geometry.
    corners: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    middle: [f64; 3],
    lo: [f32; 3],
    hi: [f32; 3],
    json: String,
}

/// The site's number as a 32-bit float, which glTF allows for an attribute of one's own, is exact so far.
const EXACT_SITES: usize = 1 << 24;

impl Glb {
    /// The triangles of an output's geometry.
    ///
    /// # Errors
    /// `Interrupted` where the observer, who is asked cell by cell, ends it.
    pub(super) fn new(
        diagram: &PowerDiagram,
        output: &Output,
        geometry: &Geometry,
        observer: &dyn Observer,
    ) -> Result<Self> {
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let points = geometry.points();
        for corner in (0..geometry.sites()).flat_map(|i| geometry.faces(i)).flat_map(|face| face.corners) {
            let x = points[*corner as usize];
            (lo, hi) = ([0, 1, 2].map(|k| lo[k].min(x[k])), [0, 1, 2].map(|k| hi[k].max(x[k])));
        }
        let middle = [0, 1, 2].map(|k| if lo[k] <= hi[k] { lo[k] + 0.5 * (hi[k] - lo[k]) } else { 0.0 });
        let colors = colors(geometry);
        let (mut cells, mut corners, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        let mut counts: Vec<usize> = Vec::new();
        let mut numbers: HashMap<u32, u32> = HashMap::new();
        for (i, &color) in colors.iter().enumerate() {
            observer.tell(0)?;
            numbers.clear();
            let (first, before) = (corners.len(), triangles.len());
            for face in geometry.faces(i) {
                let mut number = |&point: &u32| {
                    *numbers.entry(point).or_insert_with(|| {
                        corners.push(point);
                        (corners.len() - 1) as u32
                    })
                };
                let top = number(&face.corners[0]);
                let others: Vec<u32> = face.corners[1..].iter().map(number).collect();
                triangles.extend(others.windows(2).map(|pair| [top, pair[0], pair[1]]));
            }
            if corners.len() > first {
                cells.push((i as u32, rgba(color), corners.len() - first));
                counts.push(triangles.len() - before);
            }
        }
        let place = |x: f64, k: usize| (x - middle[k]) as f32;
        let (lo, hi) = ([0, 1, 2].map(|k| place(lo[k], k)), [0, 1, 2].map(|k| place(hi[k], k)));
        let mut glb = Self { cells, corners, triangles, middle, lo, hi, json: String::new() };
        glb.json = glb.json(geometry.sites(), &glb.extras(diagram, output, &counts));
        Ok(glb)
    }

    /// Bytes of its numbers.
    fn numbers(&self) -> usize {
        (12 + 4 + 4) * self.corners.len() + 12 * self.triangles.len()
    }

    /// Bytes of all of it; the format has room for 2³² less one.
    pub(super) fn bytes(&self) -> usize {
        12 + 8 + self.json.len() + if self.triangles.is_empty() { 0 } else { 8 + self.numbers() }
    }

    pub(super) fn write(&self, geometry: &Geometry, w: &mut dyn Write) -> io::Result<()> {
        let json = &self.json;
        let put = |w: &mut dyn Write, n: usize| w.write_all(&(n as u32).to_le_bytes());
        w.write_all(b"glTF")?;
        put(w, 2)?;
        put(w, self.bytes())?;
        put(w, json.len())?;
        w.write_all(b"JSON")?;
        w.write_all(json.as_bytes())?;
        if self.triangles.is_empty() {
            return Ok(());
        }
        put(w, self.numbers())?;
        w.write_all(b"BIN\0")?;
        for &corner in &self.corners {
            let x = geometry.points()[corner as usize];
            (0..3).try_for_each(|k| w.write_all(&((x[k] - self.middle[k]) as f32).to_le_bytes()))?;
        }
        for &(_, color, corners) in &self.cells {
            (0..corners).try_for_each(|_| w.write_all(&color))?;
        }
        for &(site, _, corners) in &self.cells {
            (0..corners).try_for_each(|_| w.write_all(&(site as f32).to_le_bytes()))?;
        }
        self.triangles.iter().flatten().try_for_each(|corner| w.write_all(&corner.to_le_bytes()))
    }

    /// What glTF has no words for: the units, what a status means, and of each cell, in the order of the triangles, the number of those, and its data.
    fn extras(&self, diagram: &PowerDiagram, output: &Output, counts: &[usize]) -> String {
        let listed = |text: &dyn Fn(usize) -> String| -> String {
            let all = self.cells.iter().map(|&(site, ..)| text(site as usize));
            all.collect::<Vec<_>>().join(",")
        };
        let triangles: Vec<String> = counts.iter().map(usize::to_string).collect();
        let weight = |i: usize| diagram.weights().get(i).copied().unwrap_or(0.0);
        let statuses = [CellStatus::Complete, CellStatus::Empty, CellStatus::Uncertified];
        let meaning = statuses.map(|status| format!(r#""{}":"{}""#, status.number(), status.word()));
        format!(
            r#"{{"units":{{"length":"that of the sites","volume":"length^3","weight":"length^2"}},"status":{{{}}},"cells":{{"site":[{}],"triangles":[{}],"status":[{}],"volume":[{}],"weight":[{}]}}}}"#,
            meaning.join(","),
            listed(&|i| i.to_string()),
            triangles.join(","),
            listed(&|i| output.status()[i].number().to_string()),
            listed(&|i| format!("{:?}", output.volume()[i])),
            listed(&|i| format!("{:?}", weight(i))),
        )
    }

    /// The JSON, padded with spaces to a multiple of four bytes.
    fn json(&self, sites: usize, extras: &str) -> String {
        let (corners, indices) = (self.corners.len(), 3 * self.triangles.len());
        let asset = format!(r#""asset":{{"version":"2.0","generator":"laguerre {}"}}"#, env!("CARGO_PKG_VERSION"));
        let [x, y, z] = self.middle;
        let mut json = if self.triangles.is_empty() {
            format!(r#"{{{asset},"scene":0,"scenes":[{{}}]}}"#)
        } else {
            let view = |offset: usize, length: usize, target: u32| {
                format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length},"target":{target}}}"#)
            };
            let (vertices, elements) = (34962, 34963);
            let views = [
                view(0, 12 * corners, vertices),
                view(12 * corners, 4 * corners, vertices),
                view(16 * corners, 4 * corners, vertices),
                view(20 * corners, 4 * indices, elements),
            ];
            let (float, byte, unsigned) = (5126, 5121, 5125);
            // Shortest texts that read back to the same numbers.
            let bounds = format!(r#""min":{:?},"max":{:?}"#, self.lo, self.hi);
            let has_sites = sites <= EXACT_SITES;
            let accessors = [
                format!(r#"{{"bufferView":0,"componentType":{float},"count":{corners},"type":"VEC3",{bounds}}}"#),
                format!(
                    r#"{{"bufferView":1,"componentType":{byte},"normalized":true,"count":{corners},"type":"VEC4"}}"#
                ),
                format!(r#"{{"bufferView":2,"componentType":{float},"count":{corners},"type":"SCALAR"}}"#),
                format!(r#"{{"bufferView":3,"componentType":{unsigned},"count":{indices},"type":"SCALAR"}}"#),
            ];
            let site = if has_sites { r#","_SITE":2"# } else { "" };
            format!(
                r#"{{{asset},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"cells","mesh":0,"translation":[{x:?},{y:?},{z:?}]}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":1{site}}},"indices":3,"material":0}}],"extras":{extras}}}],"materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0.0,"roughnessFactor":1.0}}}}],"buffers":[{{"byteLength":{}}}],"bufferViews":[{}],"accessors":[{}]}}"#,
                self.numbers(),
                views.join(","),
                accessors.join(",")
            )
        };
        json.extend(std::iter::repeat_n(' ', json.len().next_multiple_of(4) - json.len()));
        json
    }
}

/// Of each site a number that no site has whose cell has a face in common with its own: the least that those before it leave.
fn colors(geometry: &Geometry) -> Vec<u32> {
    let mut colors = vec![u32::MAX; geometry.sites()];
    let mut taken = Vec::new();
    for i in 0..geometry.sites() {
        taken.clear();
        taken.extend(geometry.faces(i).filter_map(|face| match face.beyond {
            Beyond::Site(j) => Some(colors[j as usize]),
            _ => None,
        }));
        colors[i] = (0..).find(|color| !taken.contains(color)).unwrap_or(0);
    }
    colors
}

/// A colour by its number: hues a golden section of the circle apart, light and dark in turn, so that the first ten differ clearly.
fn rgba(number: u32) -> [u8; 4] {
    let hue = 6.0 * (f64::from(number) * 0.618_033_988_749_895).fract();
    let value = [0.9, 0.6, 0.75][number as usize % 3];
    let channel = |k: f64| {
        let distance = ((hue - k).rem_euclid(6.0) - 3.0).abs();
        let share = (distance - 1.0).clamp(0.0, 1.0);
        (255.0 * value * (0.35 + 0.65 * share)).round() as u8
    };
    [channel(3.0), channel(5.0), channel(1.0), 255]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::Naive;
    use crate::{Backend, PowerDiagram, Request};

    fn evaluated(sites: &[[f64; 3]], at: f64) -> (PowerDiagram, Output) {
        let sites: Vec<[f64; 3]> = sites.iter().map(|p| p.map(|x| x + at)).collect();
        let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([at; 3], [at + 1.0; 3]).unwrap();
        let output = Naive::default().evaluate(&diagram, &Request::moments().with_geometry()).unwrap();
        (diagram, output)
    }

    fn number(bytes: &[u8], at: usize) -> usize {
        u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
    }

    #[test]
    fn chunks_are_as_long_as_they_say_and_triangles_enclose_the_box() {
        // So far away that 32 bits would have nothing left of a cell.
        let (diagram, output) = evaluated(&[[0.2, 0.3, 0.4], [0.7, 0.6, 0.5], [0.4, 0.8, 0.1]], 1e8);
        let geometry = output.geometry().unwrap();
        let glb = Glb::new(&diagram, &output, geometry, &()).unwrap();
        let mut file = Vec::new();
        glb.write(geometry, &mut file).unwrap();
        assert_eq!((&file[..4], number(&file, 4)), (&b"glTF"[..], 2));
        assert_eq!([number(&file, 8), glb.bytes()], [file.len(); 2]);
        let json = number(&file, 12);
        assert_eq!((json % 4, &file[16..20]), (0, &b"JSON"[..]));
        let text = std::str::from_utf8(&file[20..20 + json]).unwrap();
        assert!(text.contains(r#""translation":[100000000.5,100000000.5,100000000.5]"#), "{text}");
        assert!(text.contains(r#""min":[-0.5, -0.5, -0.5],"max":[0.5, 0.5, 0.5]"#), "{text}");
        assert!(
            text.contains(r#""status":{"0":"complete","1":"empty","2":"uncertified"},"cells":{"site":[0,1,2],"#),
            "{text}"
        );
        assert!(text.contains(&format!(r#""volume":{:?}"#, output.volume()).replace(' ', "")), "{text}");
        let depth = |bracket: [char; 2]| bracket.map(|b| text.matches(b).count());
        assert!([depth(['{', '}']), depth(['[', ']'])].iter().all(|[open, close]| open == close), "{text}");
        let binary = &file[28 + json..];
        assert_eq!((number(&file, 20 + json), &file[24 + json..28 + json]), (binary.len(), &b"BIN\0"[..]));
        let corners = glb.corners.len();
        let at = |corner: usize| -> [f64; 3] {
            let float = |k: usize| f32::from_le_bytes(binary[12 * corner + 4 * k..][..4].try_into().unwrap());
            [0, 1, 2].map(|k: usize| f64::from(float(k)))
        };
        let site = |corner: usize| f32::from_le_bytes(binary[16 * corners + 4 * corner..][..4].try_into().unwrap());
        let mut volume = 0.0;
        for triangle in binary[20 * corners..].as_chunks::<12>().0 {
            let [i, j, k] = [0, 4, 8].map(|from| number(triangle, from));
            assert!(site(i) == site(j) && site(j) == site(k));
            let [a, b, c] = [i, j, k].map(at);
            let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
            volume += (a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)) / 6.0;
        }
        assert!((volume - 1.0).abs() < 1e-6, "{volume}");
    }

    #[test]
    fn neighbours_have_different_colours() {
        let steps = [0.819_172, 0.671_043, 0.549_7];
        let sites: Vec<_> = (1..=300).map(|i| steps.map(|step: f64| (f64::from(i) * step).fract())).collect();
        let output = evaluated(&sites, 0.0).1;
        let geometry = output.geometry().unwrap();
        let colors = colors(geometry);
        for i in 0..geometry.sites() {
            for face in geometry.faces(i) {
                if let Beyond::Site(j) = face.beyond {
                    assert_ne!(rgba(colors[i]), rgba(colors[j as usize]), "{i} and {j}");
                }
            }
        }
        let most = colors.iter().max().unwrap() + 1;
        let mut all: Vec<_> = (0..most).map(rgba).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), most as usize);
        assert!(most <= 16, "{most} colours");
    }
}
