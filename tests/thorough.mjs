// How thorough a run of the tests is; for the C++ tests catch.h says it.
import { test } from "node:test";

/// True with CLOTHLAB_THOROUGH in the environment (tests/all): claims are tried on all that they are about. Otherwise,
/// as in continuous integration, the dearest are tried on a part of it.
export const thorough = process.env.CLOTHLAB_THOROUGH !== undefined;

/// A test of what a cheaper one touches, too: it is there only if the run is thorough. (One that is skipped is a
/// failure in continuous integration.)
export const thoroughTest = (...declaration) => (thorough ? test(...declaration) : undefined);

/// Of the things that a claim is about, all or, if the run is not thorough, the first `count`.
export const some = (things, count = 1) => (thorough ? things : things.slice(0, count));
