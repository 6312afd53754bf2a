//! Compiles the parser that tree-sitter has generated from `grammar.js`.

fn main() {
    println!("cargo:rerun-if-changed=src");
    cc::Build::new().std("c11").include("src").file("src/parser.c").compile("tree-sitter-clisc");
}
