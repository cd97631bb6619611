/** Okabe & Ito's colours, which stay apart under the common colour-vision deficiencies. Legs: FL, FR, RL, RR. */
export const LEG_COLOURS = ['#0072B2', '#E69F00', '#009E73', '#D55E00'];

export const PUSH_COLOUR = '#b2182b';
