/** The median of numbers; of an even count the larger one of the middle two. */
export const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
