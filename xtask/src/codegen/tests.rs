//! The mapping, construct by construct.

use super::interface::{interface, only};
use super::parity::parity;
use super::source::Unit;
use super::{Group, translate};

/// The C of a text, without the file's heading.
fn c_of(rust: &str) -> Result<String, String> {
    let Group { types, prototypes, functions, .. } = translate(vec![Unit::parse("text.rs", rust)?])?;
    Ok(format!("{types}{prototypes}{}", functions.concat()).replace("// text.rs\n", ""))
}

fn assert_c(rust: &str, lines: &[&str]) {
    let c = c_of(rust).unwrap();
    let mut rest = c.as_str();
    for line in lines {
        let Some((_, after)) = rest.split_once(line) else { panic!("no `{line}` (in order) in\n{c}") };
        rest = after;
    }
}

#[test]
fn constants_and_structs() {
    assert_c(
        "/// Half.\npub const HALF: Real = 0.5;\npub const MANY: u32 = 0xFFFF_FFF0;\n
         #[repr(C)]\npub struct Sum {\n/// Terms.\npub terms: [Real; 4],\npub count: u32,\n}",
        &[
            "// Half.\n#define HALF ((real)(REAL(0.5)))",
            "#define MANY ((uint)(0xFFFFFFF0))",
            "typedef struct {",
            "    // Terms.\n    real terms[4];",
            "    uint count;\n} Sum;",
        ],
    );
}

#[test]
fn a_loop_may_be_unrolled_or_not() {
    let looped = |attribute: &str| {
        format!(
            "#[inline]\npub fn f(n: u32) -> u32 {{\nlet mut i: u32 = 0;\n{attribute} while i < n {{\ni += 1;\n}}\nreturn i;\n}}"
        )
    };
    assert_c(&looped("#[cfg_attr(opencl, rolled)]"), &["    ROLLED\n    while (i < n) {"]);
    assert_c(&looped("#[cfg_attr(opencl, unrolled)]"), &["    UNROLLED\n    while (i < n) {"]);
    assert!(c_of(&looped("#[cfg_attr(opencl, rolls)]")).unwrap_err().contains("such attribute"));
}

#[test]
fn constants_have_a_value_of_their_own_in_single_precision() {
    assert_c(
        "/// Tiny.\n#[cfg_attr(opencl, single(0.25))]\nconst TINY: Real = 0.5;",
        &["#if SINGLE", "#define TINY ((real)(REAL(0.25)))", "#else", "#define TINY ((real)(REAL(0.5)))", "#endif"],
    );
}

#[test]
fn functions_may_be_something_else_on_devices() {
    assert_c(
        "#[cfg_attr(opencl, returns(\"fma(a, b, c)\"))]\nfn f(a: Real, b: Real, c: Real) -> Real { return a; }",
        &["    return fma(a, b, c);\n}"],
    );
}

#[test]
fn the_store_is_called_and_locals_are_pointed_to() {
    assert_c(
        "fn f<S: CellStore>(s: &mut S, sum: &mut Sum) -> u32 {
            let p: Plane = s.plane(3);
            sum.count = sum.count + s.planes();
            sum.terms[sum.count as usize] = p.d.abs();
            *sum = Sum::default();
            let mut part: Sum = Sum { count: 1 };
            g(s, sum, &mut part);
            return COMPLETE;
        }",
        &[
            "INLINE uint f(Store *s, Sum *sum) {",
            "const Plane p = store_plane(s, 3);",
            "sum->count = sum->count + store_planes(s);",
            "sum->terms[sum->count] = fabs(p.d);",
            "*sum = (Sum){ 0 };",
            "Sum part = (Sum){ .count = 1 };",
            "g(s, sum, &part);",
            "return COMPLETE;",
        ],
    );
}

#[test]
fn bounds_that_have_room_are_single_and_integers_wrap_where_they_say_so() {
    assert_c(
        "const NONE: Rough = 0.0;\nfn f(x: Rough, i: u32) -> Rough {\n    let at: u32 = (i + 1).wrapping_sub(2);\n    \
         return (x - NONE).max(NONE).sqrt();\n}",
        &[
            "#define NONE ((float)(REAL(0.0)))",
            "float f(float x, uint i)",
            "at = ((i + 1) - 2);",
            "sqrt(fmax((x - NONE), NONE))",
        ],
    );
}

#[test]
fn how_much_is_inlined_is_said() {
    assert_c("#[cfg_attr(opencl, hot)]\nfn f() {\n}", &["HOT void f() {"]);
    assert_c("#[inline]\n#[cfg_attr(opencl, outline)]\nfn f() {\n}", &["OUTLINE void f() {"]);
    assert_c("fn f() {\n}", &["INLINE void f() {"]);
    let both = "#[cfg_attr(opencl, hot, outline)]\nfn f() {\n}";
    assert!(c_of(both).unwrap_err().contains("function that is both"));
}

#[test]
fn statements_keep_their_comments() {
    assert_c(
        "#[inline(always)]\nfn f(n: u32) -> u32 {\n    // 1. Count.\n    let mut i: u32 = 0;\n    while i < n {\n        \
         // Skip.\n        if (i & 1) == 0 {\n            i += 2;\n            continue;\n        } else if i > 9 {\n\
         break;\n        } else {\n            i = i + 1;\n        }\n    }\n    loop {\n        break;\n    }\n    return i;\n}",
        &[
            "INLINE uint f(uint n) {",
            "    // 1. Count.\n    uint i = 0;",
            "    while (i < n) {\n        // Skip.",
            "if ((i & 1) == 0) {",
            "continue;",
            "} else if (i > 9) {",
            "break;",
            "} else {",
            "for (;;) {",
            "return i;",
        ],
    );
}

#[test]
fn a_range_is_gone_through() {
    assert_c(
        "fn f(n: u32) {\n    #[cfg_attr(opencl, rolled)]\n    for i in 1..n + 2 {\n        g(i);\n    }\n}",
        &["    ROLLED\n    for (uint i = 1; i < (n + 2); i++) {\n        g(i);\n    }"],
    );
}

#[test]
fn operands_are_grouped_as_rust_groups_them() {
    // C ranks `&` below `==`.
    assert_c(
        "fn f(i: u32) -> u32 {\n    if i & 1 == 0 {\n        return 1;\n    }\n    return 0;\n}",
        &["if ((i & 1) == 0) {"],
    );
}

#[test]
fn what_the_dialect_lacks_is_refused_with_its_line() {
    for (rust, said) in [
        ("fn f() {\n    let x = 1;\n}", "text.rs line 2: the dialect has no local without type"),
        ("fn f() {\n    for i in 0..=3 {}\n}", "text.rs line 2: the dialect has no loop but over `a..b`"),
        ("fn f(x: Real) -> Real {\n    return x.min(1.0);\n}", "text.rs line 2: the dialect has no such method"),
        ("fn f() -> (u32, u32) {\n}", "text.rs line 1: the dialect has no such type"),
        ("#[cfg_attr(opencl, returns(1))]\nconst A: Real = 1.0;", "text.rs line 1: the dialect has no such attribute"),
        ("#[cfg_attr(opencl, single(B))]\nconst A: Real = 1.0;", "text.rs line 1: the dialect has no such value"),
        ("const A: u32 = 1;\nconst A: u32 = 2;", "text.rs line 2: the dialect has no second `A`"),
    ] {
        assert_eq!(c_of(rust).err().as_deref(), Some(said));
    }
}

#[test]
fn a_function_that_can_be_called_gets_a_kernel_and_its_twin() {
    let text = "pub struct Sum { pub terms: [Real; 2], pub count: u32 }\npub struct Hidden { x: Real }\n
                pub(super) fn f<S: CellStore>(s: &mut S, tag: u32, sum: &mut Sum) -> u32 { return 0; }\n
                pub fn g(x: Hidden) {}\nfn h() {}";
    let made = parity(&[&Unit::parse("core/src/cell/text.rs", text).unwrap()]).unwrap();
    for line in [
        "for (uint i = 0; i < 2u; i++) value.terms[i] = take_real(in);",
        "__kernel void parity_f(PARITY_ARGUMENTS) {",
        "PARITY_STORE;",
        "const uint tag = take_uint(&in);",
        "Sum sum = take_Sum(&in);",
        "const uint result = f(s, tag, &sum);",
        "give_uint(&out, result);\n    give_Sum(&out, sum);\n    parity_dump(&out, s);",
    ] {
        assert!(made.kernels.contains(line), "no `{line}` in\n{}", made.kernels);
    }
    assert!(made.table.contains("host!(s, (tag: u32 = TAG_CONE, sum: Sum) text::f(&mut s, tag, &mut sum), [sum]),"));
    assert!(made.table.contains("words!(Sum { terms, count });"));
    assert!(!made.kernels.contains("parity_g") && !made.kernels.contains("parity_h"));
}

/// The C of a module of the interface.
fn interface_of(rust: &str) -> Result<String, String> {
    interface(Vec::new(), vec![Unit::parse("text.rs", rust)?], "double")
}

#[test]
fn shared_structs_have_the_hosts_layout() {
    let c = interface_of(
        "const MOST: usize = 3;\n#[repr(C)]\nstruct Inner { x: f64 }\n
         #[repr(C)]\nstruct Shared { inner: Inner, large: u64, few: [u32; MOST], last: i32 }",
    )
    .unwrap();
    assert!(c.contains("    Inner inner;\n    ulong large;\n    uint few[MOST];\n    int last;\n} Shared;"), "{c}");
    assert!(c.contains("[(sizeof(Shared) == 32) ? 1 : -1]"), "{c}");
}

#[test]
fn a_layout_that_compilers_may_choose_is_refused() {
    for (fields, what) in [("a: u32, b: f64", "before a field"), ("a: f64, b: u32", "at the end"), ("a: bool", "type")]
    {
        let error = interface_of(&format!("#[repr(C)]\nstruct Shared {{ {fields} }}")).unwrap_err();
        assert!(error.contains(what), "{error}");
    }
    assert!(interface_of("struct Shared { a: u32 }").unwrap_err().contains("repr(C)"));
}

#[test]
fn what_is_borrowed_must_be_there() {
    let unit = || Unit::parse("text.rs", "const A: u32 = 1;\nconst B: u32 = 2;").unwrap();
    assert_eq!(only(unit(), &["B"]).unwrap().items.len(), 1);
    assert!(only(unit(), &["B", "C"]).is_err_and(|error| error == "text.rs has no `C`"));
}

#[test]
fn a_kernels_parameters_and_groups_of_them() {
    let c = interface_of(
        "kernels! {
            /// Of all.
            group Inputs { input corners: [f64; 3], input sites: [f64; 4] }
            kernel Sort = sort_all { group inputs: Inputs, value count: u32, output places: [u32; 2], atomic sum: u32 }
        }",
    )
    .unwrap();
    let inputs = "    __global const double *corners, \\\n    __global const double4 *sites";
    assert!(c.contains("// Of all.\ntypedef struct {\n    __global const double *corners;\n"), "{c}");
    assert!(c.contains("#define INPUTS_OF_ARGUMENTS ((Inputs){ \\\n    .corners = corners, \\\n"), "{c}");
    let own = "uint count, \\\n    __global uint2 *places, \\\n    volatile __global uint *sum\n";
    assert!(c.contains(&format!("#define SORT_ALL_ARGUMENTS \\\n{inputs}, \\\n    {own}")), "{c}");
}

#[test]
fn what_no_kernel_can_have_is_refused_with_its_line() {
    for parameter in ["inout x: u32", "group x: Nothing", "input x: [f64; 5]", "input x: &u32"] {
        let error = interface_of(&format!("kernels! {{\n kernel K = k {{ {parameter} }}\n}}")).unwrap_err();
        assert!(error.starts_with("text.rs line 2: "), "{error}");
    }
    assert!(interface_of("kernels! { function K {} }").unwrap_err().contains("expected `kernel` or `group`"));
}
