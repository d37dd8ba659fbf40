//! The examples that are in the program.

/// An example.
pub struct Example {
    /// Name of its file, below `examples/`.
    pub name: &'static str,
    /// What it makes.
    pub title: &'static str,
    pub text: &'static str,
}

/// All examples except `spirograph.nc`, which is larger than a file of a package should be.
pub const EXAMPLES: [Example; 34] = [
    Example {
        name: "circles.nc",
        title: "three circles on the micro mill, with the backlash of each axis",
        text: include_str!("../../../examples/circles.nc"),
    },
    Example {
        name: "gear.nc",
        title: "a gear of 12 teeth, by absolute centres of arcs",
        text: include_str!("../../../examples/gear.nc"),
    },
    Example {
        name: "ornament.nc",
        title: "a rosette of arcs: an axis reverses 45 times",
        text: include_str!("../../../examples/ornament.nc"),
    },
    Example {
        name: "star.nc",
        title: "a star of eight points, by arcs with a radius",
        text: include_str!("../../../examples/star.nc"),
    },
    Example {
        name: "head.nc",
        title: "a symmetric head, for the order of its cuts",
        text: include_str!("../../../examples/head.nc"),
    },
    Example {
        name: "turning.nc",
        title: "a stepped shaft, for the lathe",
        text: include_str!("../../../examples/turning.nc"),
    },
    Example {
        name: "thread.nc",
        title: "a thread in three passes, for the lathe",
        text: include_str!("../../../examples/thread.nc"),
    },
    Example {
        name: "board.drl",
        title: "holes and a slot of a circuit board",
        text: include_str!("../../../examples/board.drl"),
    },
    Example {
        name: "piece.toml",
        title: "a part for the simulated measuring machine",
        text: include_str!("../../../examples/piece.toml"),
    },
    Example {
        name: "piece.routine",
        title: "finds that part and measures it",
        text: include_str!("../../../examples/piece.routine"),
    },
    Example {
        name: "piece.nc",
        title: "measures its bore and its boss, as a G-code program",
        text: include_str!("../../../examples/piece.nc"),
    },
    Example {
        name: "microfactory/square.nc",
        title: "a square with its diagonal",
        text: include_str!("../../../examples/microfactory/square.nc"),
    },
    Example {
        name: "microfactory/horizontal.nc",
        title: "a lying rectangle with its diagonal",
        text: include_str!("../../../examples/microfactory/horizontal.nc"),
    },
    Example {
        name: "microfactory/vertical.nc",
        title: "a standing rectangle with its diagonal",
        text: include_str!("../../../examples/microfactory/vertical.nc"),
    },
    Example {
        name: "microfactory/triangle.nc",
        title: "a triangle",
        text: include_str!("../../../examples/microfactory/triangle.nc"),
    },
    Example {
        name: "microfactory/zigzag.fig",
        title: "a zigzag in counted steps",
        text: include_str!("../../../examples/microfactory/zigzag.fig"),
    },
    Example {
        name: "cam/bcnc.ngc",
        title: "in the style of bCNC",
        text: include_str!("../../../examples/cam/bcnc.ngc"),
    },
    Example {
        name: "cam/carbide.nc",
        title: "in the style of Carbide Create",
        text: include_str!("../../../examples/cam/carbide.nc"),
    },
    Example {
        name: "cam/cura.gcode",
        title: "in the style of Cura",
        text: include_str!("../../../examples/cam/cura.gcode"),
    },
    Example {
        name: "cam/estlcam.nc",
        title: "in the style of Estlcam",
        text: include_str!("../../../examples/cam/estlcam.nc"),
    },
    Example {
        name: "cam/flatcam.nc",
        title: "in the style of FlatCAM",
        text: include_str!("../../../examples/cam/flatcam.nc"),
    },
    Example {
        name: "cam/freecad.nc",
        title: "in the style of FreeCAD",
        text: include_str!("../../../examples/cam/freecad.nc"),
    },
    Example {
        name: "cam/fusion.nc",
        title: "in the style of Fusion",
        text: include_str!("../../../examples/cam/fusion.nc"),
    },
    Example {
        name: "cam/heekscnc.tap",
        title: "in the style of HeeksCNC",
        text: include_str!("../../../examples/cam/heekscnc.tap"),
    },
    Example {
        name: "cam/inkscape.ngc",
        title: "in the style of Inkscape",
        text: include_str!("../../../examples/cam/inkscape.ngc"),
    },
    Example {
        name: "cam/kirimoto.nc",
        title: "in the style of Kiri:Moto",
        text: include_str!("../../../examples/cam/kirimoto.nc"),
    },
    Example {
        name: "cam/lightburn.gc",
        title: "in the style of LightBurn",
        text: include_str!("../../../examples/cam/lightburn.gc"),
    },
    Example {
        name: "cam/mastercam.nc",
        title: "in the style of Mastercam",
        text: include_str!("../../../examples/cam/mastercam.nc"),
    },
    Example {
        name: "cam/pcb2gcode.ngc",
        title: "in the style of pcb2gcode",
        text: include_str!("../../../examples/cam/pcb2gcode.ngc"),
    },
    Example {
        name: "cam/prusaslicer.gcode",
        title: "in the style of PrusaSlicer",
        text: include_str!("../../../examples/cam/prusaslicer.gcode"),
    },
    Example {
        name: "cam/solidcam.nc",
        title: "in the style of SolidCAM",
        text: include_str!("../../../examples/cam/solidcam.nc"),
    },
    Example {
        name: "cam/vectric.tap",
        title: "in the style of Vectric",
        text: include_str!("../../../examples/cam/vectric.tap"),
    },
    Example {
        name: "cam/wrapped.tap",
        title: "a ring wrapped around a rod, in the style of Vectric",
        text: include_str!("../../../examples/cam/wrapped.tap"),
    },
    Example {
        name: "cam/README.md",
        title: "what is special in each program of cam/",
        text: include_str!("../../../examples/cam/README.md"),
    },
];

#[cfg(test)]
mod tests {
    use super::EXAMPLES;
    use std::path::Path;

    /// Paths of the files in a folder of `examples/`, below that.
    fn files(folder: &str) -> Vec<String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
        let entries = std::fs::read_dir(root.join(folder)).unwrap();
        let files = entries
            .map(Result::unwrap)
            .filter(|entry| entry.path().is_file());
        files
            .map(|entry| format!("{folder}{}", entry.file_name().to_string_lossy()))
            .collect()
    }

    #[test]
    fn every_example_is_in_the_program() {
        let mut expected = [files(""), files("cam/"), files("microfactory/")].concat();
        expected.retain(|name| name != "spirograph.nc");
        expected.sort_unstable();
        let mut names: Vec<_> = EXAMPLES.iter().map(|example| example.name).collect();
        names.sort_unstable();
        assert_eq!(names, expected);
    }
}
