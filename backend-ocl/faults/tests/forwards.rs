//! The library itself: that it is where the tests of the program look for it, and fails when it is told to.

use std::env;
use std::path::PathBuf;
use std::ptr;

use dlopen2::raw::Library;

#[test]
fn the_second_call_fails_and_the_others_are_handed_on() {
    // SAFETY: this is the only test of this program, and no other thread reads the environment.
    unsafe { env::set_var("LAGUERRE_FAULT", "clGetPlatformIDs:2:-6") };
    let tests = env::current_exe().unwrap();
    let name = format!("{}laguerre_ocl_faults{}", env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX);
    let folders = tests.ancestors().skip(1).take(2);
    let path: PathBuf = folders.map(|folder| folder.join(&name)).find(|path| path.exists()).unwrap();
    let library = Library::open(path).unwrap();
    type GetPlatforms = unsafe extern "C" fn(u32, *mut usize, *mut u32) -> i32;
    // SAFETY: the function is declared with this type.
    let get: GetPlatforms = unsafe { library.symbol("clGetPlatformIDs") }.unwrap();
    let mut count = 0;
    // SAFETY: no room is given for platforms, and their number has a place.
    let [first, second, third] = [(); 3].map(|()| unsafe { get(0, ptr::null_mut(), &raw mut count) });
    // With OpenCL and without, it says the same again.
    assert!(second == -6 && first == third && (first == 0 || first == -1001), "{first} {second} {third}");
}
