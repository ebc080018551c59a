"""A hand that holds an object which is knocked: motors, grasp, sensed fingers, and who controls them."""
