//! Words that are commands elsewhere: in other editions, other tracers, other courses' handouts.
//!
//! Who writes one of them knows what is wanted; the answer says how this language has it, or that it has not.

use crate::syntax::spec::CommandKind::{self, Background, Cylinder, Fov, Light, Sphere, Surface, Write};

/// Words of one meaning.
#[derive(Debug)]
pub(super) struct Foreign {
    /// The words, in lower case.
    words: &'static [&'static str],
    /// What such a word is where it is a command, in a few words.
    pub(super) label: &'static str,
    /// What to do instead.
    pub(super) help: &'static str,
    /// The command that does the same here, if there is one.
    pub(super) meant: Option<CommandKind>,
}

/// Returns what is known of a word, in lower case.
pub(super) fn find(word: &str) -> Option<&'static Foreign> {
    FOREIGN.iter().find(|foreign| foreign.words.contains(&word))
}

const fn row(
    words: &'static [&'static str],
    meant: Option<CommandKind>,
    label: &'static str,
    help: &'static str,
) -> Foreign {
    Foreign { words, label, help, meant }
}

/// What is known of other languages.
static FOREIGN: [Foreign; 36] = [
    // Where the scene is seen from.
    row(
        &["eye", "from", "position", "viewpoint", "eye_point", "location", "origin"],
        None,
        "sets the eye in other languages",
        "the eye is at the origin: subtract its place from all others instead",
    ),
    row(
        &["uvw", "at", "up", "lookat", "look_at", "look", "camera", "cam", "perspective", "view"],
        None,
        "sets the camera in other languages",
        "the eye is at the origin and looks along −z: move the objects and lights instead, and set the angle with `fov`",
    ),
    row(
        &["angle", "fovy", "field_of_view", "viewangle", "view_angle"],
        Some(Fov),
        "sets the angle of view in other languages",
        "write `fov angle`, in degrees, from the lower to the upper edge",
    ),
    row(
        &["resolution", "size", "width", "height", "film", "imsize", "dimensions"],
        None,
        "sets the size of the image in other languages",
        "the size is no part of a scene: use `clisc run --size 640x480`",
    ),
    row(
        &["samples", "rays_per_pixel", "antialias", "sampler", "spp", "jitter"],
        None,
        "sets the samples of a pixel in other languages",
        "the samples are no part of a scene: use `clisc run --samples 4`",
    ),
    row(
        &["maxdepth", "max_depth", "depth", "recursion", "bounces", "integrator", "max_trace_level"],
        None,
        "sets the number of reflections in other languages",
        "a ray is reflected up to eight times; `clisc run --max-level` sets another number",
    ),
    // What saves the image.
    row(&["render"], Some(Write), "renders and saves the image in the edition 2022", "write `write name.png`"),
    row(
        &["save", "output", "export", "picture", "image", "file", "outfile", "draw", "show"],
        Some(Write),
        "saves the image in other languages",
        "write `write name.png`, which renders the scene as it then stands",
    ),
    // Objects.
    row(
        &["ball", "circle", "orb", "globe", "sph", "spheroid"],
        Some(Sphere),
        "a sphere in other languages",
        "write `sphere x y z radius`",
    ),
    row(
        &["tube", "pillar", "column", "rod", "disc_cylinder", "hollow_cylinder"],
        Some(Cylinder),
        "a cylinder in other languages",
        "write `cylinder radius x z ymin ymax`: it stands upright and is closed",
    ),
    row(
        &["cone"],
        None,
        "an object of the edition 2019",
        "there are spheres and upright cylinders; a stack of flat cylinders comes near a cone",
    ),
    row(
        &["disk", "disc", "ring"],
        None,
        "a flat disk, as in the edition 2020",
        "a flat cylinder is a level disk: `cylinder radius x z ymin ymax`; tilted ones there are none",
    ),
    row(
        &["ellipsoid", "ellipse", "torus", "quadric", "blob", "superellipsoid"],
        None,
        "an object of other languages",
        "there are spheres and upright cylinders; several spheres side by side come near other shapes",
    ),
    row(
        &["begin", "vertex", "end"],
        None,
        "part of a triangle, as in the editions 2014, 2017 and 2022",
        "there are no triangles: the objects are spheres and upright cylinders",
    ),
    row(
        &[
            "triangle",
            "tri",
            "polygon",
            "poly",
            "mesh",
            "quad",
            "face",
            "v",
            "vn",
            "f",
            "trimesh",
            "smooth_triangle",
            "obj",
        ],
        None,
        "an object with corners in other languages",
        "there are no triangles: the objects are spheres and upright cylinders",
    ),
    row(
        &["plane", "ground", "floor", "wall", "rectangle"],
        None,
        "a plane in other languages",
        "a large flat cylinder is a ground: `cylinder 20 0 0 -2 -1`; so is a huge sphere",
    ),
    row(
        &["box", "cube", "brick", "prism"],
        None,
        "a box in other languages",
        "there are no boxes: the objects are spheres and upright cylinders",
    ),
    row(
        &["object", "shape", "primitive", "union", "difference", "intersection", "merge", "csg", "group"],
        None,
        "begins an object or a group in other languages",
        "a line holds one object, such as `sphere x y z radius`; there are no groups",
    ),
    // Transformations.
    row(
        &["translate", "move", "trans", "shift"],
        None,
        "moves objects in other languages",
        "there are no transformations: write each place as it is to be",
    ),
    row(
        &["rotate", "rot", "turn"],
        None,
        "turns objects in other languages",
        "there are no transformations: write each place as it is to be; cylinders always stand upright",
    ),
    row(
        &["scale", "transform", "matrix", "concattransform", "xft"],
        None,
        "transforms objects in other languages",
        "there are no transformations: write each place and radius as it is to be",
    ),
    row(
        &["push", "pop", "pushtransform", "poptransform", "pushmatrix", "popmatrix", "identity"],
        None,
        "keeps a transformation in other languages",
        "there are no transformations: leave it out and write each place as it is to be",
    ),
    row(
        &["attributebegin", "attributeend", "worldbegin", "worldend", "transformbegin", "transformend", "scene"],
        None,
        "begins or ends a block in other languages",
        "there are no blocks: leave it out; commands run in order, from the first line to the last",
    ),
    // Surfaces.
    row(
        &["material", "mat", "mtl", "usemtl", "newmtl", "texture", "pigment", "finish", "makenamedmaterial", "surf"],
        Some(Surface),
        "sets what objects are made of in other languages",
        "write `surface Car Cag Cab Cdr Cdg Cdb Csr Csg Csb P Krefl` before the objects: ambient, diffuse and specular \
         colour, exponent, reflection",
    ),
    row(
        &["color", "colour", "rgb", "diffuse", "fill"],
        Some(Surface),
        "sets the colour of objects in other languages",
        "the diffuse colour is the second of `surface`: `surface 0.1 0 0   0.8 0 0   0 0 0   1   0` is red",
    ),
    row(
        &["ambient", "ambient_light", "ambientlight", "lta"],
        Some(Surface),
        "sets the ambient light in other languages",
        "the ambient colour is the first of `surface`, for each surface its own",
    ),
    row(
        &["specular", "shininess", "shine", "phong", "reflective", "reflect", "reflection", "reflectivity", "mirror"],
        Some(Surface),
        "sets highlights or mirrors in other languages",
        "they are the last numbers of `surface`: Csr Csg Csb (the colour of highlights), P (how sharp they are), Krefl (mirror, 0 to 1)",
    ),
    row(
        &[
            "transparency",
            "refraction",
            "ior",
            "glass",
            "emission",
            "emissive",
            "normal",
            "bump",
            "checker",
            "noise",
            "wood",
            "marble",
        ],
        None,
        "an effect of other languages",
        "there is no such effect: a `surface` has an ambient, a diffuse and a specular colour and a reflectance",
    ),
    // Lights.
    row(
        &[
            "point_light",
            "pointlight",
            "light_source",
            "lightsource",
            "lamp",
            "point",
            "ltp",
            "bulb",
            "omni",
            "positional",
        ],
        Some(Light),
        "a light in other languages",
        "write `light r g b x y z`: the colour comes before the place",
    ),
    row(
        &["spotlight", "spot_light", "spot"],
        Some(Light),
        "a light in other languages",
        "there are point lights only: `light r g b x y z`, which shine everywhere",
    ),
    row(
        &["directional", "directional_light", "dirlight", "sun", "ltd", "distant"],
        Some(Light),
        "a light from far away in other languages",
        "there are point lights only: `light r g b x y z` with a place far away",
    ),
    row(
        &["area_light", "arealight", "disk_light", "attenuation", "falloff", "intensity"],
        None,
        "a light, or how it fades, in other languages",
        "there are point lights only, `light r g b x y z`, which are as bright far away as near",
    ),
    // The rest.
    row(
        &[
            "backgroundcolor",
            "background_color",
            "backgroundcolour",
            "bg",
            "bgcolor",
            "sky",
            "skycolor",
            "clear",
            "clearcolor",
        ],
        Some(Background),
        "sets the background in other languages",
        "write `background r g b`",
    ),
    row(
        &["fog", "environment", "envmap", "skybox", "atmosphere"],
        None,
        "sets what surrounds a scene in other languages",
        "there is a `background r g b` and nothing else around the objects",
    ),
    row(
        &["include", "import", "read", "interpreter", "source", "#include", "mtllib", "load"],
        None,
        "reads another file in other languages",
        "a scene is one file: copy the lines of the other into it",
    ),
    row(
        &[
            "declare", "define", "let", "set", "var", "const", "macro", "for", "while", "repeat", "loop", "if",
            "print", "echo", "reset", "exit", "quit",
        ],
        None,
        "a statement of other languages",
        "a scene does not calculate: it has no variables and no loops; let a program write the lines",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::editions::{Edition, FORMS};
    use crate::syntax::spec;

    #[test]
    fn a_word_stands_once_and_is_no_command() {
        let mut words: Vec<_> = FOREIGN.iter().flat_map(|foreign| foreign.words).collect();
        words.sort_unstable();
        assert!(words.windows(2).all(|pair| pair[0] != pair[1]), "{words:?}");
        assert!(words.iter().all(|word| spec::find(word).is_none() && word.to_lowercase() == **word));
        assert!(words.len() > 150);
    }

    /// A word one slip away from a command is likelier that.
    #[test]
    fn a_word_is_far_from_every_command() {
        for word in FOREIGN.iter().flat_map(|foreign| foreign.words) {
            let near = spec::COMMANDS.iter().find(|spec| strsim::osa_distance(word, spec.name) <= spec.name.len() / 4);
            assert!(near.is_none(), "{word} is near {near:?}");
        }
    }

    #[test]
    fn the_commands_of_other_editions_have_an_answer() {
        for form in FORMS.iter().filter(|form| !form.editions.has(Edition::OURS)) {
            assert!(spec::find(form.name).is_some() || find(form.name).is_some(), "{}", form.name);
        }
    }
}
