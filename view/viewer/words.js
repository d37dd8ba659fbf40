/**
 * The texts of the viewer, in English and Spanish.
 */

const ENGLISH = {
    path: "Tool path",
    pathHelp:
        "Arrow keys move the picture, Shift with arrow keys turns it, plus and minus zoom, " +
        "F fits the part, T the table. Click a line to see its program line.",
    view: "View",
    fitPart: "Fit part",
    fitTable: "Fit table",
    zoomIn: "Zoom in",
    zoomOut: "Zoom out",
    measure: "Measure",
    real: "Real path",
    program: "Program",
    programHelp: "Up and Down select a line; its moves are marked in the picture.",
    line: "Line",
    time: "Time",
    play: "Play",
    pause: "Pause",
    speed: "Playing speed",
    previousLine: "Previous line",
    nextLine: "Next line",
    previousEvent: "Previous event",
    nextEvent: "Next event",
    axis: "axis",
    work: "work",
    machine: "machine",
    commanded: "commanded",
    lag: "real − commanded",
    feed: "Feed",
    spindle: "Spindle",
    state: "State",
    move: "Move",
    deviation: "Deviation",
    values: "At this instant",
    charts: "Over time",
    chartHelp: "Left and Right move the time. Drag selects a span.",
    speedChart: "Speed",
    accelerationChart: "Acceleration",
    jerkChart: "Jerk",
    deviationChart: "Deviation",
    whole: "Whole time",
    span: "Span",
    findings: "Findings",
    jog: "jog",
    rapid: "rapid, home",
    thread: "thread",
    probe: "probe",
    feedKind: "feed",
    takeUp: "backlash take-up",
    dwell: "dwell",
    still: "stands still",
    start: "start",
    area: "work area",
    measured: "Distance",
    measureHelp: "Click two points.",
    cut: "The program is longer than this report can show: the last moves are left out.",
    noMoves: "The program has no moves.",
    broken: "The viewer cannot show this report",
    from: "from",
    to: "to",
    least: "least",
    most: "most",
    mean: "mean",
    exact: "exact to the step",
    sampled: "between samples of",
    cutting: "Material",
    diameter: "Tool diameter",
    stock: "Show material",
    removed: "Removed",
    gouge: "too deep",
    uncut: "left",
    crossed: "cut in a rapid",
};

/** @type {typeof ENGLISH} */
const SPANISH = {
    path: "Trayectoria de la herramienta",
    pathHelp:
        "Las flechas mueven la imagen, Mayús con flechas la gira, más y menos acercan y alejan, " +
        "F encuadra la pieza, T la mesa. Un clic en una línea muestra su línea del programa.",
    view: "Vista",
    fitPart: "Encuadrar pieza",
    fitTable: "Encuadrar mesa",
    zoomIn: "Acercar",
    zoomOut: "Alejar",
    measure: "Medir",
    real: "Trayectoria real",
    program: "Programa",
    programHelp: "Arriba y Abajo eligen una línea; sus movimientos se marcan en la imagen.",
    line: "Línea",
    time: "Tiempo",
    play: "Reproducir",
    pause: "Pausa",
    speed: "Velocidad de reproducción",
    previousLine: "Línea anterior",
    nextLine: "Línea siguiente",
    previousEvent: "Suceso anterior",
    nextEvent: "Suceso siguiente",
    axis: "eje",
    work: "pieza",
    machine: "máquina",
    commanded: "mandada",
    lag: "real − mandada",
    feed: "Avance",
    spindle: "Husillo",
    state: "Estado",
    move: "Movimiento",
    deviation: "Desviación",
    values: "En este instante",
    charts: "En el tiempo",
    chartHelp: "Izquierda y Derecha mueven el tiempo. Arrastrar elige un intervalo.",
    speedChart: "Velocidad",
    accelerationChart: "Aceleración",
    jerkChart: "Sacudida",
    deviationChart: "Desviación",
    whole: "Todo el tiempo",
    span: "Intervalo",
    findings: "Avisos",
    jog: "manual",
    rapid: "rápido, origen",
    thread: "rosca",
    probe: "palpado",
    feedKind: "avance",
    takeUp: "recuperación del juego",
    dwell: "espera",
    still: "parada",
    start: "inicio",
    area: "zona de trabajo",
    measured: "Distancia",
    measureHelp: "Haga clic en dos puntos.",
    cut: "El programa es más largo de lo que cabe en este informe: faltan los últimos movimientos.",
    noMoves: "El programa no tiene movimientos.",
    broken: "El visor no puede mostrar este informe",
    from: "de",
    to: "a",
    least: "mínimo",
    most: "máximo",
    mean: "media",
    exact: "exacto al paso",
    sampled: "entre muestras cada",
    cutting: "Material",
    diameter: "Diámetro de la herramienta",
    stock: "Mostrar material",
    removed: "Arrancado",
    gouge: "demasiado hondo",
    uncut: "sin cortar",
    crossed: "cortado en rápido",
};

/** @typedef {typeof ENGLISH} Words */

/**
 * The texts in the language of the reader.
 *
 * @param {string} language such as `es-MX`
 * @returns {Words}
 */
export function wordsOf(language) {
    return language.toLowerCase().startsWith("es") ? SPANISH : ENGLISH;
}

/**
 * The name of a kind of move.
 *
 * @param {Words} words
 * @param {typeof import("husillo/viewer/scene.js").KINDS[number]} kind
 */
export function kindName(words, kind) {
    return kind === "feed" ? words.feedKind : words[kind];
}
