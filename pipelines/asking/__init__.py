"""Which runs are there, and what they come to: answers to questions asked at a terminal."""
