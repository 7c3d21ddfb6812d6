"""What a robot can be asked, by theme: parts of the class `ulna.Robot`."""
