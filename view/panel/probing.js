/**
 * The probing cycles of the wizards: which moves they make, and which work zero follows. Positions
 * are in millimetres; contacts are in the machine frame.
 */

/**
 * What a cycle moves: a machine with a probe.
 *
 * @typedef {"X" | "Y" | "Z"} Letter
 *
 * @typedef {object} Rig
 * @property {(axis: Letter, distance: number, feed: number) => Promise<number>} touch moves
 * towards the part until the contact, and returns the machine position of that axis there; fails
 * without a contact
 * @property {(axis: Letter, distance: number, feed: number) => Promise<void>} beside moves along
 * the part where nothing should be; fails at a contact
 * @property {(axis: Letter, distance: number) => Promise<void>} away moves at the rapid rate by a
 * distance, away from the part
 * @property {(axis: Letter, position: number) => Promise<void>} to moves at the rapid rate to a
 * machine position
 * @property {(zero: Partial<Record<Letter, number>>) => Promise<void>} zero sets the work zero:
 * machine positions
 * @property {(length: number) => Promise<void>} offset sets the tool length offset
 *
 * @typedef {object} Values what the operator gives, mm and mm/min
 * @property {number} distance longest way of a search
 * @property {number} searchFeed of the first touch
 * @property {number} touchFeed of the second touch, which counts
 * @property {number} retract way back between both, and at the end
 * @property {number} thickness of the plate
 * @property {number} tip diameter of the tool or of the ball
 * @property {number} depth how far below the start the sides are touched
 * @property {number} clearance how far outside of the part the tool goes down
 */

/** The values that a wizard begins with. @type {Values} */
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
 * @param {Letter} axis
 * @param {1 | -1} side
 * @param {Values} values
 * @param {number} [distance]
 */
async function touchTwice(rig, axis, side, values, distance = values.distance) {
    const { retract, searchFeed, touchFeed } = values;
    await rig.touch(axis, side * distance, searchFeed);
    await rig.away(axis, -side * retract);
    const contact = await rig.touch(axis, side * 2 * retract, touchFeed);
    await rig.away(axis, -side * retract);
    return contact;
}

/**
 * The top of the part, or of a plate on it, becomes Z 0.
 *
 * @param {Rig} rig
 * @param {Values} values
 */
export async function height(rig, values) {
    const contact = await touchTwice(rig, "Z", -1, values);
    await rig.zero({ Z: contact - values.thickness });
}

/**
 * One side of the part: outwards, down, and back to the side. Ends above the start.
 *
 * @param {Rig} rig
 * @param {"X" | "Y"} axis
 * @param {1 | -1} side which side of the part: -1 is the left one or the front
 * @param {Values} values
 * @returns {Promise<number>} the machine position of the side
 */
async function sideOf(rig, axis, side, values) {
    const { depth, clearance, searchFeed, tip, retract } = values;
    await rig.away(axis, side * clearance);
    await rig.beside("Z", -depth, searchFeed);
    const inwards = side === 1 ? -1 : 1;
    const contact = await touchTwice(rig, axis, inwards, values, clearance + tip);
    await rig.away("Z", depth);
    const edge = contact + (inwards * tip) / 2;
    // Back over the part, as far inside as the tool stood before.
    await rig.to(axis, edge + inwards * retract);
    return edge;
}

/**
 * A corner of the part becomes X 0 and Y 0. The tool starts above the part, near to that corner.
 *
 * @param {Rig} rig
 * @param {Values} values
 * @param {[1 | -1, 1 | -1]} corner its sides in X and Y: -1 is left, and front
 */
export async function corner(rig, values, [across, along]) {
    const x = await sideOf(rig, "X", across, values);
    const y = await sideOf(rig, "Y", along, values);
    await rig.zero({ X: x, Y: y });
}

/**
 * The centre of a hole becomes X 0 and Y 0. The tip starts in the hole, below its edge.
 *
 * @param {Rig} rig
 * @param {Values} values
 * @returns {Promise<Record<"X" | "Y", number>>} the diameters of the hole
 */
export async function centreOfHole(rig, values) {
    const sizes = { X: 0, Y: 0 };
    const centres = { X: 0, Y: 0 };
    // X a second time: across the centre of Y it is a diameter, before it may be a chord.
    for (const axis of /** @type {const} */ (["X", "Y", "X"])) {
        const low = await touchTwice(rig, axis, -1, values);
        const high = await touchTwice(rig, axis, 1, values, 2 * values.distance);
        sizes[axis] = high - low + values.tip;
        centres[axis] = (low + high) / 2;
        await rig.to(axis, centres[axis]);
    }
    await rig.zero(centres);
    return sizes;
}

/**
 * The length of a tool by its touch of a plate at a fixed place.
 *
 * @param {Rig} rig
 * @param {Values} values
 * @param {number} [reference] machine position at which the first tool touched the plate
 * @returns {Promise<number>} that of this tool. Without `reference` it is that of the first tool
 */
export async function toolLength(rig, values, reference) {
    const contact = await touchTwice(rig, "Z", -1, values);
    await rig.offset(reference === undefined ? 0 : contact - reference);
    return contact;
}
