// Desired positions among the inputs of a part, by the names that servo groups give them
// (hwparts/servo_group/port_layout.h). Pure.

export const kDesired = /^Desired (Angle|.*Position)$/; // the group
// The name of the output
export const actualOf = (desired: string): string => desired.replace(/^Desired /, "Actual ");
