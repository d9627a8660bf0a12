"""LunarLander and BipedalWalker in C++ on Box2D's own source, bit for bit as in Gymnasium."""
