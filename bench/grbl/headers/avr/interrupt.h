/* Grbl's parser names nothing of this header. */
