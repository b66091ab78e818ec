//! The text for NVIDIA's GPUs, which PoCL cannot compile for its PTX, by clang and NVIDIA's assembler, where there is no GPU: that it compiles, and what
//! each stage's build takes there. The driver has a compiler of its own: its numbers are others, but what changes them does here, too.

use std::env;
use std::fs;
use std::iter;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::run::{cargo, install, succeed, target};

/// From PyPI: NVIDIA's assembler.
const PACKAGE: &str = "nvidia-cuda-nvcc-cu12==12.9.86";
const IN_PACKAGE: &str = "nvidia/cuda_nvcc/bin/ptxas";

/// The functions of OpenCL C for NVIDIA's GPUs, of libclc (Debian and Ubuntu).
const LIBRARY: &str = "/usr/lib/clc/nvptx64--nvidiacl.bc";

pub(crate) fn run() -> Result<(), String> {
    let clang = clang()?;
    if !Path::new(LIBRARY).exists() {
        return Err(format!("there is no {LIBRARY}: install libclc of clang's version"));
    }
    let home = target().join("nvptx");
    let assembler = assembler(&home)?;
    let texts = home.join("texts");
    drop(fs::remove_dir_all(&texts));
    fs::create_dir_all(&texts).map_err(|error| format!("{}: {error}", texts.display()))?;
    let folder = texts.display().to_string();
    // (Of the whole workspace, as tests are, so that nothing is built twice.)
    cargo(&["build", "--locked", "--workspace", "--all-features", "--example", "warp_texts"], &[])?;
    let program = target().join("debug/examples/warp_texts").with_extension(env::consts::EXE_EXTENSION);
    succeed(Command::new(program).arg(&folder))?;
    let mut paths = fs::read_dir(&texts)
        .and_then(|all| all.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>())
        .map_err(|error| format!("{folder}: {error}"))?;
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "cl"));
    paths.sort();
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let (clang, assembler) = (clang.as_path(), assembler.as_path());
    // (One takes half a second or forty: each thread takes the next.)
    let next = AtomicUsize::new(0);
    let one_after_another = || {
        let mine = iter::from_fn(|| paths.get(next.fetch_add(1, Ordering::Relaxed)));
        mine.map(|path| (path, row(clang, assembler, path))).collect::<Vec<_>>()
    };
    let mut rows: Vec<(&PathBuf, Result<String, String>)> = thread::scope(|scope| {
        let all: Vec<_> = (0..threads).map(|_| scope.spawn(one_after_another)).collect();
        let ended = all.into_iter().map(|one| one.join().map_err(|_| "a thread died".to_owned()));
        ended.collect::<Result<Vec<_>, _>>().map(|all| all.into_iter().flatten().collect())
    })?;
    rows.sort_by_key(|&(path, _)| path);
    println!("| build | registers | spilled, bytes | local memory, bytes | text, bytes |");
    println!("|---|---:|---:|---:|---:|");
    for (_, row) in rows {
        println!("{}", row?);
    }
    Ok(())
}

/// The newest clang that is there.
fn clang() -> Result<PathBuf, String> {
    let folders: Vec<PathBuf> = env::var_os("PATH").map(|path| env::split_paths(&path).collect()).unwrap_or_default();
    let names = (15..30).rev().map(|version| format!("clang-{version}")).chain(["clang".to_owned()]);
    names
        .flat_map(|name| folders.iter().map(move |folder| folder.join(&name)))
        .find(|path| path.exists())
        .ok_or_else(|| "there is no clang: install clang-19 and libclc-19, or others of one version".to_owned())
}

/// The assembler, installed where it is not there.
fn assembler(home: &Path) -> Result<PathBuf, String> {
    let find = || {
        let versions = fs::read_dir(home.join("lib")).ok()?;
        versions
            .flatten()
            .map(|version| version.path().join("site-packages").join(IN_PACKAGE))
            .find(|path| path.exists())
    };
    if let Some(found) = find() {
        return Ok(found);
    }
    install(home, &[PACKAGE])?;
    find().ok_or_else(|| format!("{PACKAGE} has no {IN_PACKAGE}"))
}

/// Compiles a text: what it takes, as a row of the table.
fn row(clang: &Path, assembler: &Path, text: &Path) -> Result<String, String> {
    let about =
        fs::read_to_string(text.with_extension("txt")).map_err(|error| format!("{}: {error}", text.display()))?;
    let (name, options) = about.split_once('\n').unwrap_or_default();
    let (registers, defined): (Vec<&str>, Vec<&str>) =
        options.split_whitespace().partition(|option| option.starts_with("-cl-nv-maxrregcount="));
    let (ptx, code) = (text.with_extension("ptx"), text.with_extension("cubin"));
    let mut compile = Command::new(clang);
    compile.args(["-x", "cl", "-cl-std=CL1.2", "-target", "nvptx64-nvidia-cuda", "-O3", "-S", "-w"]);
    let inner = ["-target-cpu", "sm_80", "-target-feature", "+ptx70", "-finclude-default-header"];
    for option in inner.into_iter().chain(["-mlink-builtin-bitcode", LIBRARY]) {
        compile.args(["-Xclang", option]);
    }
    // (The standard has `__asm__` alone.)
    compile.args(["-Dcl_khr_fp64", "-Dasm=__asm__"]).args(&defined).arg(text).arg("-o").arg(&ptx);
    succeed(&mut compile).map_err(|error| format!("{name}: {error}"))?;
    let most = registers.first().map(|option| option.replace("-cl-nv-maxrregcount", "--maxrregcount"));
    let mut assemble = Command::new(assembler);
    assemble.args(["-arch=sm_90", "-v"]).args(most).arg(&ptx).arg("-o").arg(&code);
    let output = assemble.output().map_err(|error| format!("{}: {error}", assembler.display()))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(format!("{name}: {}", said.trim_end()));
    }
    let [registers, spilled, local] = taken(&said).ok_or_else(|| format!("{name}: the assembler says {said}"))?;
    let object = fs::read(&code).map_err(|error| format!("{}: {error}", code.display()))?;
    let text = section(&object, ".text.cells").ok_or_else(|| format!("{name}: no kernel in {}", code.display()))?;
    Ok(format!("| {name} | {registers} | {spilled} | {local} | {text} |"))
}

/// Registers, bytes that are spilled (stores and loads in the text) and bytes of local memory of the kernel, as the assembler says them.
fn taken(said: &str) -> Option<[u64; 3]> {
    let kernel: Vec<&str> =
        said.lines().skip_while(|line| !line.contains("Compiling entry function 'cells'")).skip(1).take(3).collect();
    let before = |what: &str| {
        let line = kernel.iter().find(|line| line.contains(what))?;
        line.split(what).next()?.split_whitespace().last()?.parse::<u64>().ok()
    };
    let spilled = before(" bytes spill stores")? + before(" bytes spill loads")?;
    Some([before(" registers")?, spilled, before(" bytes smem").unwrap_or(0)])
}

/// The length of a section of an ELF file of 64 bits.
fn section(object: &[u8], name: &str) -> Option<u64> {
    let number = |at: usize, bytes: usize| {
        let mut word = [0; 8];
        word[..bytes].copy_from_slice(object.get(at..at + bytes)?);
        Some(u64::from_le_bytes(word))
    };
    let (table, size, count) = (number(40, 8)? as usize, number(58, 2)? as usize, number(60, 2)? as usize);
    let names = number(table + size * number(62, 2)? as usize + 24, 8)? as usize;
    (0..count).map(|i| table + i * size).find_map(|header| {
        let at = names + number(header, 4)? as usize;
        let its = object.get(at..)?.split(|&byte| byte == 0).next()?;
        if its == name.as_bytes() { number(header + 32, 8) } else { None }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_assembler_says_is_read() {
        let said = "ptxas info    : 0 bytes gmem\nptxas info    : Compiling entry function 'cells' for 'sm_90'\n\
                    ptxas info    : Function properties for cells\n    128 bytes stack frame, 316 bytes spill stores, 272 bytes spill loads\n\
                    ptxas info    : Used 96 registers, used 0 barriers, 128 bytes cumulative stack size, 41280 bytes smem\n";
        assert_eq!(taken(said), Some([96, 588, 41_280]));
        assert_eq!(taken("ptxas info    : 0 bytes gmem"), None);
    }
}
