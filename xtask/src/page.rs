//! The program's pages as a user meets them, in a headless Chromium: what is seen, what a click and a slider do, and how soon.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tiny_skia::{Pixmap, PremultipliedColorU8};

use crate::browser::Browser;
use crate::run::{cargo, succeed, target};

/// A machine without a graphics card draws on its processor.
const SOFTWARE: [&str; 2] = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const DESKTOP: [u32; 2] = [1280, 800];
const PHONE: [u32; 2] = [390, 844];
/// The first picture of 100,000 cells is to be there within so many milliseconds, once in so many tries: other work may be going on.
const SOON: f64 = 3000.0;
const TRIES: usize = 3;

pub(crate) fn run() -> Result<(), String> {
    // The program as its own tests have it, so that nothing is built twice.
    cargo(&["test", "--locked", "--workspace", "--all-features", "--no-run", "--test", "program"], &[])?;
    let folder = target().join("pages");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let laguerre = |arguments: &str| {
        let program = target().join("debug").join(format!("laguerre{}", std::env::consts::EXE_SUFFIX));
        succeed(Command::new(program).current_dir(&folder).args(arguments.split(' ')))
    };
    laguerre("sample white 100000 --box 0,0,0,1,1,1 -o many.npy")?;
    laguerre("integrate many.npy --box 0,0,0,1,1,1 --html many.html")?;
    laguerre("demo --out-dir demo")?;
    laguerre("sample white 2000 --box 0,0,0,1,1,1 -o few.npy")?;
    laguerre("transport few.npy --box 0,0,0,1,1,1 --html transport.html")?;
    laguerre("lloyd few.npy --box 0,0,0,1,1,1 --tolerance 0.02 --html lloyd.html")?;
    laguerre("fluid rayleigh-taylor --particles 2000 --steps 20 --html fluid.html")?;
    for (width, size) in [("desktop", DESKTOP), ("phone", PHONE)] {
        let mut browser = Page::start(&folder, size, &SOFTWARE)?;
        browser.demo(&folder.join("demo/cells.html"))?;
        browser.many(&folder.join("many.html"))?;
        for name in ["transport", "lloyd", "fluid"] {
            browser.run(&folder.join(format!("{name}.html")))?;
        }
        println!("{width} ({} × {}): as it should be", size[0], size[1]);
    }
    let mut browser = Page::start(&folder, DESKTOP, &["--disable-3d-apis"])?;
    browser.without_webgl(&folder.join("demo/cells.html"))
}

struct Page {
    browser: Browser,
    size: [u32; 2],
}

/// Fails with what was expected.
fn expect(is_so: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if is_so { Ok(()) } else { Err(what()) }
}

impl Page {
    fn start(folder: &Path, size: [u32; 2], options: &[&str]) -> Result<Self, String> {
        let profile: PathBuf = folder.join("profile");
        Ok(Self { browser: Browser::start(&profile, size[0], size[1], options)?, size })
    }

    /// Opens a page and waits for its picture; milliseconds from the start of the page to that.
    fn open(&mut self, path: &Path) -> Result<f64, String> {
        self.browser.open(path)?;
        let name = path.display().to_string();
        self.browser.until(&format!("location.href.endsWith({name:?}) && window.laguerre && laguerre.firstPicture"))?;
        self.number("laguerre.firstPicture")
    }

    fn number(&mut self, expression: &str) -> Result<f64, String> {
        let value = self.browser.value(expression)?;
        value.as_f64().ok_or_else(|| format!("{expression} is {value}"))
    }

    /// Nothing went wrong that the page or the browser tells of.
    fn is_quiet(&self, path: &Path) -> Result<(), String> {
        let complaints = &self.browser.complaints;
        expect(complaints.is_empty(), || format!("{}: {}", path.display(), complaints.join("; ")))
    }

    /// The picture, of which the canvas is not blank: many colours, also in the middle.
    fn picture(&mut self) -> Result<Pixmap, String> {
        // Two frames later what was asked for is there.
        self.browser.value(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 30))))",
        )?;
        let picture = self.browser.picture()?;
        let [x, y] = self.middle()?.map(|x| x as usize);
        let of_row = |row: usize| &picture.pixels()[row * self.size[0] as usize..][x.saturating_sub(100)..x + 100];
        let colors: HashSet<[u8; 3]> =
            (y - 60..y + 60).flat_map(of_row).map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
        expect(colors.len() > 100, || format!("the picture has {} colours in its middle", colors.len()))?;
        Ok(picture)
    }

    /// The middle of the canvas.
    fn middle(&mut self) -> Result<[f64; 2], String> {
        let of = |side: &str, length: &str| {
            format!("(() => {{ const box = canvas.getBoundingClientRect(); return box.{side} + box.{length} / 2; }})()")
        };
        Ok([self.number(&of("left", "width"))?, self.number(&of("top", "height"))?])
    }

    /// Moves a slider as a hand does, and waits until what it asks for is drawn.
    fn slide(&mut self, id: &str, value: u32) -> Result<Pixmap, String> {
        let event = "dispatchEvent(new Event('input', { bubbles: true }))";
        self.browser.value(&format!(
            "{{ const slider = document.getElementById('{id}'); slider.value = {value}; slider.{event}; }}"
        ))?;
        self.picture()
    }

    /// Pages fit the screen, and what is under a thumb is large enough for it.
    fn fits(&mut self) -> Result<(), String> {
        let wide = self.number("document.documentElement.scrollWidth")?;
        expect(wide <= f64::from(self.size[0]), || format!("the page is {wide} pixels wide"))?;
        if self.size == PHONE {
            expect(self.browser.value("getComputedStyle(panel).display === 'none'")? == true, || {
                "the controls hide the picture".into()
            })?;
            self.browser.value("document.getElementById('open').click()")?;
            let small = "[...document.querySelectorAll('#panel select, #panel > .row input, #panel > .row button')]\
                .filter((one) => one.offsetParent && one.getBoundingClientRect().height < 36).length";
            let small = self.number(small)?;
            expect(small == 0.0, || format!("{small} controls are too small for a thumb"))?;
        }
        Ok(())
    }

    /// 100,000 cells: the first picture, the cut, cells that stand apart.
    fn many(&mut self, path: &Path) -> Result<(), String> {
        let mut best = f64::INFINITY;
        for _ in 0..TRIES {
            best = best.min(self.open(path)?);
            if best <= SOON {
                break;
            }
        }
        expect(best <= SOON, || format!("the first picture of 100,000 cells took {best:.0} ms"))?;
        let whole = self.picture()?;
        let turning = self.number("laguerre.spin(10)")?;
        let half = self.slide("cut", 500)?;
        expect(half != whole, || "the cut changes nothing".into())?;
        let cut = self.number("laguerre.spin(10)")?;
        let through = self.through(&half)?;
        self.slide("cut", 1000)?;
        let apart = self.slide("spread", 50)?;
        expect(apart != whole, || "cells do not stand apart".into())?;
        let moving = self.number("laguerre.spin(10)")?;
        println!(
            "100,000 cells, {} kB: first picture after {best:.0} ms; a frame takes {turning:.0} ms, cut in half {cut:.0} ms, through cells {through:.0} ms, \
             apart {moving:.0} ms",
            fs::metadata(path).map_or(0, |file| file.len() / 1000)
        );
        self.is_quiet(path)
    }

    /// A cut through cells instead of around them, as `around`: it is filled, by cells that the plane goes through. How long a frame takes.
    fn through(&mut self, around: &Pixmap) -> Result<f64, String> {
        self.browser.value("document.getElementById('through').click()")?;
        let picture = self.picture()?;
        expect(picture != *around, || "cells are not cut through".into())?;
        // Seen nearly along x, the cut's axis, the middle of the picture is the cut.
        let wrong = self.number(
            "(() => {
                const { x, y, z } = laguerre.view().camera.position, box = canvas.getBoundingClientRect();
                laguerre.view().camera.position.set(x + 9 * laguerre.view().radius, y, z);
                laguerre.view().controls.update();
                const { isCut } = laguerre.cutThrough(), cells = laguerre.view().cells, at = laguerre.view().extent[0] / 2;
                let wrong = 0, beyond = 0;
                for (let k = 0; k < 25; k++) {
                    const across = box.width / 2 + 20 * (k % 5 - 2), down = box.height / 2 + 20 * (Math.floor(k / 5) - 2);
                    const cell = laguerre.pickAt(across, down);
                    if (!isCut[cell]) wrong++;
                    else if (cells.barycenter[3 * cell] > at) beyond++;
                }
                laguerre.view().home();
                return beyond > 0 ? wrong : 25;
            })()",
        )?;
        // Of those with the barycenter beyond it, which a cut around cells leaves out, some too.
        expect(wrong == 0.0, || format!("{wrong} of 25 points of a cut through cells are not of cells that it cuts"))?;
        let frame = self.number("laguerre.spin(10)")?;
        self.browser.value("document.getElementById('through').click()")?;
        Ok(frame)
    }

    /// Picking, by the pointer and by the keyboard; colours.
    fn demo(&mut self, path: &Path) -> Result<(), String> {
        let first = self.open(path)?;
        let turning = self.number("laguerre.spin(10)")?;
        println!("10,000 cells: first picture after {first:.0} ms; a frame takes {turning:.0} ms");
        self.fits()?;
        let before = self.picture()?;
        let [x, y] = self.middle()?;
        // The swan's body is below the middle of its box.
        let (x, y) = (x, y + 0.08 * f64::from(self.size[0].min(800)));
        self.browser.click(x, y)?;
        let picked = self.number("laguerre.seen().picked")?;
        let under =
            format!("laguerre.view().cells.site[laguerre.pickAt({x} - canvas.getBoundingClientRect().left, {y})]");
        let under = self.number(&under)?;
        let neighbours = self.number("document.querySelectorAll('#neighbours button').length")?;
        let title = self.browser.value("document.querySelector('#picked h2').textContent")?;
        expect(picked == under && title == format!("Cell of site {picked}"), || format!("picked {picked}: {title}"))?;
        expect(neighbours >= 3.0, || format!("{neighbours} neighbours"))?;
        let lit = self.picture()?;
        expect(lit != before, || "nothing is lit".into())?;
        // What is lit is what was clicked: red, but for an edge that may pass there.
        let is_red =
            |pixel: PremultipliedColorU8| pixel.red() > 130 && pixel.green() < pixel.red() / 2 && pixel.blue() < 70;
        let near = (-2..=2).flat_map(|dx| (-2..=2).map(move |dy| [x + f64::from(dx), y + f64::from(dy)]));
        let pixels: Vec<_> = near.filter_map(|[x, y]| lit.pixel(x as u32, y as u32)).collect();
        expect(pixels.iter().any(|&pixel| is_red(pixel)), || "not lit where it was clicked".into())?;
        // A neighbour has it as a neighbour.
        self.browser.value("document.querySelector('#neighbours button').click()")?;
        let back = format!(
            "[...document.querySelectorAll('#neighbours button')].some((one) => one.textContent.startsWith('site {picked}area'))"
        );
        expect(self.browser.value(&back)? == true, || format!("the neighbour of {picked} does not know it"))?;
        self.browser.value("document.getElementById('alone').click()")?;
        self.browser.value("new Promise((done) => setTimeout(done, 100))")?;
        let alone = self.number("laguerre.seen().vertices")?;
        expect(alone < 3000.0, || format!("a cell and its neighbours have {alone} vertices"))?;
        self.browser.value("canvas.focus()")?;
        self.browser.key("Escape")?;
        expect(self.browser.value("laguerre.seen().picked")?.is_null(), || "Escape does not let go".into())?;
        let still = self.picture()?;
        self.browser.key("ArrowLeft")?;
        let turned = self.picture()?;
        expect(turned != still, || "the arrow key does not turn".into())?;
        self.browser.drag([x, y], [x + 60.0, y])?;
        expect(self.picture()? != turned, || "dragging does not turn".into())?;
        expect(self.browser.value("laguerre.seen().picked")?.is_null(), || "dragging picks".into())?;
        for color in ["weight", "status", "volume"] {
            let choose = format!(
                "field.value = '{color}'; field.dispatchEvent(new Event('change')); legend.textContent + legend.innerHTML.length"
            );
            let legend = self.browser.value(&choose)?;
            expect(legend.as_str().is_some_and(|text| text.len() > 10), || {
                format!("the legend of {color} is {legend}")
            })?;
        }
        self.picture()?;
        self.is_quiet(path)
    }

    /// A run: its states, and its curve.
    fn run(&mut self, path: &Path) -> Result<(), String> {
        self.open(path)?;
        let states = self.number("laguerre.meta.states.length")? as u32;
        expect(states >= 3, || format!("{}: {states} states", path.display()))?;
        if self.size == PHONE {
            self.browser.value("document.getElementById('open').click()")?;
        }
        let last = self.picture()?;
        self.browser.value("laguerre.pickSite(7)")?;
        let curve = "document.getElementById('plot').toDataURL()";
        let marked = self.browser.value(curve)?;
        let slider = "state.value = 0; state.dispatchEvent(new Event('input'))";
        self.browser.value(&slider.replace("state.", "document.getElementById('state')."))?;
        self.browser.until(
            "laguerre.seen().state === 0 && document.getElementById('state-label').textContent.includes('(1 of')",
        )?;
        expect(self.picture()? != last, || format!("{}: all states look alike", path.display()))?;
        expect(self.browser.value(curve)? != marked, || "the curve does not show the state".into())?;
        expect(self.browser.value("laguerre.seen().picked")? == 7, || "the picked site is lost".into())?;
        let inked = "(() => { const p = document.getElementById('plot'), d = p.getContext('2d').getImageData(0, 0, p.width, p.height).data; \
            let n = 0; for (let k = 3; k < d.length; k += 4) n += d[k] > 0; return n; })()";
        let inked = self.number(inked)?;
        expect(inked > 500.0, || format!("{}: the curve has {inked} pixels", path.display()))?;
        self.browser.value("document.getElementById('play').click()")?;
        self.browser.until(&format!("laguerre.seen().state === {}", states - 1))?;
        self.is_quiet(path)
    }

    /// Where nothing can be drawn, why, and the figures all the same.
    fn without_webgl(&mut self, path: &Path) -> Result<(), String> {
        self.browser.open(path)?;
        self.browser.until("document.getElementById('message') && message.textContent.includes('no WebGL 2')")?;
        let facts = self.browser.value("document.getElementById('facts').textContent")?;
        expect(facts.as_str().is_some_and(|text| text.contains("10,000")), || format!("the figures are {facts}"))?;
        println!("without WebGL: said");
        self.is_quiet(path)
    }
}
