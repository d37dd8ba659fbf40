/**
 * The probing cycles of the wizards: which moves they make, and which work zero follows. Lengths
 * are in millimetres; contacts are in the machine frame.
 */

/**
 * What a cycle moves: a machine with a probe.
 *
 * @typedef {"x" | "y" | "z"} Axis
 *
 * @typedef {object} Rig
 * @property {(axis: Axis, by: number, feed: number, back: number, set?: number) => Promise<number>}
 * touch moves by at most `by` until the contact, then back; the contact becomes the work coordinate
 * `set`. Returns the machine position of the contact. Fails without one
 * @property {(axis: Axis, by: number, feed: number) => Promise<void>} beside moves where nothing
 * should be; fails at a contact
 * @property {(axis: Axis, by: number) => Promise<void>} away moves away from the part, or over it
 * @property {(axis: Axis, position: number) => Promise<void>} to moves to a machine position
 * @property {(at: Partial<Record<Axis, number>>) => Promise<void>} zero makes the present position
 * these work coordinates
 * @property {(length: number) => Promise<void>} offset sets the tool length offset
 *
 * @typedef {object} Values what the operator gives: mm, and mm/min
 * @property {number} distance longest distance of a search
 * @property {number} searchFeed of the first touch
 * @property {number} touchFeed of the second touch, which counts
 * @property {number} retract distance back after a touch
 * @property {number} thickness of the plate
 * @property {number} tip diameter of the tool or of the ball
 * @property {number} depth how far below the start the sides are touched
 * @property {number} clearance how far outwards the tool goes before it goes down
 */

/** The values that the wizards begin with. @type {Values} */
export const VALUES = {
    distance: 20,
    searchFeed: 100,
    touchFeed: 25,
    retract: 2,
    thickness: 0,
    tip: 3,
    depth: 5,
    clearance: 10,
};

/**
 * Touches twice in one direction: fast, then slowly. Ends away from the part.
 *
 * @param {Rig} rig
 * @param {Values} values
 * @param {Axis} axis
 * @param {number} by signed
 * @param {number} [set] the work coordinate of the second contact
 */
async function touchTwice(rig, { retract, searchFeed, touchFeed }, axis, by, set) {
    await rig.touch(axis, by, searchFeed, retract);
    // Twice the distance back: the first contact was a little beyond the part.
    return rig.touch(axis, Math.sign(by) * 2 * retract, touchFeed, retract, set);
}

/**
 * The top of the part, or of a plate on it, becomes Z 0 or the thickness of the plate.
 *
 * @param {Rig} rig
 * @param {Values} values
 */
export async function height(rig, values) {
    await touchTwice(rig, values, "z", -values.distance, values.thickness);
}

/**
 * A side of the part becomes 0: outwards, down, back to the side, up, and over the part again.
 *
 * @param {Rig} rig
 * @param {Values} values
 * @param {"x" | "y"} axis
 * @param {1 | -1} side which side of the part: -1 is the left one, or the front
 */
export async function side(rig, values, axis, side) {
    const { depth, clearance, searchFeed, tip, retract } = values;
    await rig.away(axis, side * clearance);
    await rig.beside("z", -depth, searchFeed);
    // At the contact the middle of the tip is half a diameter outside of the side.
    const inwards = -side * (clearance + tip);
    await touchTwice(rig, values, axis, inwards, (side * tip) / 2);
    await rig.away("z", depth);
    await rig.away(axis, -side * (2 * retract + tip));
}

/**
 * A corner of the part becomes X 0 and Y 0. The tool starts above the part, near to that corner.
 *
 * @param {Rig} rig
 * @param {Values} values
 * @param {[1 | -1, 1 | -1]} sides of the corner in X and Y: -1 is left, and front
 */
export async function corner(rig, values, [x, y]) {
    await side(rig, values, "x", x);
    await side(rig, values, "y", y);
}

/**
 * The centre of a hole becomes X 0 and Y 0. The tip starts in the hole, below its edge.
 *
 * @param {Rig} rig
 * @param {Values} values
 * @returns {Promise<Record<"x" | "y", number>>} the diameters of the hole in X and in Y
 */
export async function centre(rig, values) {
    const sizes = { x: 0, y: 0 };
    // X twice: before Y is in the middle, X measures a chord.
    for (const axis of /** @type {const} */ (["x", "y", "x"])) {
        const low = await touchTwice(rig, values, axis, -values.distance);
        const high = await touchTwice(rig, values, axis, 2 * values.distance);
        sizes[axis] = high - low + values.tip;
        await rig.to(axis, (low + high) / 2);
    }
    await rig.zero({ x: 0, y: 0 });
    return sizes;
}

/**
 * The length of a tool, by its touch of a plate at a fixed place. The offset of the first tool is
 * 0, that of another one the difference.
 *
 * @param {Rig} rig
 * @param {Values} values
 * @param {number} [reference] the contact of the first tool
 * @returns {Promise<number>} the contact of this tool
 */
export async function toolLength(rig, values, reference) {
    const contact = await touchTwice(rig, values, "z", -values.distance);
    await rig.offset(reference === undefined ? 0 : contact - reference);
    return contact;
}
