"""Hand that holds an object while a pin hits it: motors, grasp, sensors of the fingers, and the controller."""
